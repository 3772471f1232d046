// What planted faults need besides a line at their place (shared/planted_faults.h).
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "film/spectral_film.hpp"
#include "shared/planted_faults.h"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Makes one tile of 8 x 8 pixels, or one pixel, of the block's means brighter.
/// block  in pixels of the film
/// means  [pixel of the block][stride]
inline void plant_in_means(uint32_t fault, const PixelRect& block, std::span<float> means,
                           std::size_t stride) {
  for (std::size_t i = 0; i < means.size(); ++i) {
    const auto pixel = static_cast<uint32_t>(i / stride);
    const uint32_t x = block.x0 + pixel % block.width, y = block.y0 + pixel / block.width;
    if (fault == KB_PLANTED_TILE_BIAS && x / 8 == 1 && y / 8 == 1) means[i] *= 1.01f;
    if (fault == KB_PLANTED_PIXEL_BIAS && x == 9 && y == 13) means[i] *= 1.05f;
  }
}

/// The wavelength of the table's entry that is nearest.
inline double nearest_entry_nm(const RegularTable& table, double lambda_nm) {
  return table.min_nm + std::round((lambda_nm - table.min_nm) / table.step_nm) * table.step_nm;
}

}  // namespace kiloband
