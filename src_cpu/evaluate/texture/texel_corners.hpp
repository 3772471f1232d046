// The four texels of a saved bilinear lookup.
#pragma once

#include <cstddef>

#include "shared/records.h"

namespace kiloband::cpu {

/// Texels (x0, y0) (x1, y0) (x0, y1) (x1, y1) by their number in the texture, and their weights.
struct TexelCorners {
  std::size_t texel[4];
  double weight[4];

  TexelCorners(const KbTexture& texture, const KbTextureSample& sample) {
    const bool environment = texture.flags & KB_TEXTURE_ENVMAP;
    const uint32_t wrap_x = environment ? KB_WRAP_REPEAT : texture.wrap;
    const uint32_t wrap_y = environment ? KB_WRAP_CLAMP : texture.wrap;
    for (uint32_t corner = 0; corner < 4; ++corner) {
      const uint32_t dx = corner & 1, dy = corner >> 1;
      const uint32_t x = wrapped((sample.xy & 0xffffu) + dx, texture.width, wrap_x);
      const uint32_t y = wrapped((sample.xy >> 16) + dy, texture.height, wrap_y);
      const double fx = sample.fx, fy = sample.fy;
      texel[corner] = static_cast<std::size_t>(y) * texture.width + x;
      weight[corner] = (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy);
    }
  }

 private:
  static uint32_t wrapped(uint32_t i, uint32_t size, uint32_t wrap) {
    if (i < size) return i;
    if (wrap == KB_WRAP_REPEAT) return i % size;
    if (wrap == KB_WRAP_CLAMP) return size - 1;
    const uint32_t j = i % (2 * size);
    return j < size ? j : 2 * size - 1 - j;
  }
};

}  // namespace kiloband::cpu
