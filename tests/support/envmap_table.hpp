// What the tables of an environment map (scene/compile/light/envmap_sampling.hpp) are held against: probabilities of cells, facings of normals.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"
#include "shared/environment.h"

namespace kiloband::test {

/// Where the four distributions begin that choose a cell, and its place in each.
struct EnvmapCell {
  const float *down, *across, *row, *column;
  uint32_t down_cell, across_cell, row_cell, column_cell;

  EnvmapCell(const EnvmapSampling& s, uint32_t map_row, uint32_t map_column, uint32_t facing) {
    const std::size_t regions_down = s.regions_down(), regions_across = s.regions_across();
    down_cell = map_row >> s.row_shift;
    across_cell = map_column >> s.column_shift;
    row_cell = map_row - (down_cell << s.row_shift);
    column_cell = map_column - (across_cell << s.column_shift);
    down = &s.facing_cdf.at(facing * (regions_down + 1 + regions_down * (regions_across + 1)));
    across = down + regions_down + 1 + down_cell * (regions_across + 1);
    row = &s.row_cdf.at((down_cell * regions_across + across_cell) * ((std::size_t{1} << s.row_shift) + 1));
    column =
        &s.column_cdf.at((map_row * regions_across + across_cell) * ((std::size_t{1} << s.column_shift) + 1));
  }
};

/// Of a cell, for receivers of a facing.
inline double envmap_probability(const EnvmapSampling& s, uint32_t row, uint32_t column,
                                 uint32_t facing = KB_ALL_FACINGS) {
  const EnvmapCell at(s, row, column, facing);
  const auto step = [](const float* cdf, uint32_t i) { return static_cast<double>(cdf[i + 1]) - cdf[i]; };
  return step(at.down, at.down_cell) * step(at.across, at.across_cell) * step(at.row, at.row_cell) *
         step(at.column, at.column_cell);
}

/// Facing of a normal in the map's frame, which need not have length 1: the definition, in double precision.
inline uint32_t facing_of_normal(const glm::dvec3& normal) {
  const double size = std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z);
  double a = normal.x / size, b = normal.z / size;
  if (normal.y < 0) {
    const double folded = (1 - std::fabs(b)) * std::copysign(1, a);
    b = (1 - std::fabs(a)) * std::copysign(1, b);
    a = folded;
  }
  const auto cell = [](double c) {
    return static_cast<uint32_t>(std::clamp((c + 1) * (KB_FACINGS_ACROSS / 2), 0.0, KB_FACINGS_ACROSS - 1.0));
  };
  return cell(a) + KB_FACINGS_ACROSS * cell(b);
}

}  // namespace kiloband::test
