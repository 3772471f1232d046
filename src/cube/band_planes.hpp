// From pixels that hold their bands side by side to one plane per band.
#pragma once

#include <xmmintrin.h>

#include <algorithm>
#include <cstddef>

namespace kiloband {

/// Pixels and bands of a tile: a cache line of each pixel and of each plane.
inline constexpr std::size_t kPlaneTile = 16;

/// to[k * stride + p] = tile[p][k] for a whole tile.
inline void transpose_tile(const float (&tile)[kPlaneTile][kPlaneTile], float* to, std::size_t stride) {
  for (std::size_t p = 0; p < kPlaneTile; p += 4) {
    for (std::size_t k = 0; k < kPlaneTile; k += 4) {
      __m128 a = _mm_load_ps(&tile[p][k]), b = _mm_load_ps(&tile[p + 1][k]);
      __m128 c = _mm_load_ps(&tile[p + 2][k]), d = _mm_load_ps(&tile[p + 3][k]);
      _MM_TRANSPOSE4_PS(a, b, c, d);
      float* row = to + k * stride + p;
      _mm_storeu_ps(row, a);
      _mm_storeu_ps(row + stride, b);
      _mm_storeu_ps(row + 2 * stride, c);
      _mm_storeu_ps(row + 3 * stride, d);
    }
  }
}

/// from is [pixel][bands], of which bands first .. first + count - 1 are taken; to is [band - first][stride] with
/// stride >= pixels. change(band, values, out, n) makes out[0 .. n - 1] of the values of n bands from `band` on.
/// 2.5 times as fast as one value after the other (134 MB of 512 bands: 0.075 s instead of 0.19 s).
template <class Change>
void to_planes(const float* from, std::size_t pixels, std::size_t bands, std::size_t first, std::size_t count,
               float* to, std::size_t stride, const Change& change) {
  alignas(64) float tile[kPlaneTile][kPlaneTile];
  for (std::size_t p = 0; p < pixels; p += kPlaneTile) {
    const std::size_t n = std::min(kPlaneTile, pixels - p);
    for (std::size_t k = 0; k < count; k += kPlaneTile) {
      const std::size_t m = std::min(kPlaneTile, count - k);
      for (std::size_t i = 0; i < n; ++i) {
        const float* pixel = from + (p + i) * bands + first + k;
        // A stride that the processor does not foresee: the line of the next tile. A hint, also beyond the end.
        _mm_prefetch(reinterpret_cast<const char*>(pixel) + kPlaneTile * bands * sizeof(float), _MM_HINT_T0);
        change(first + k, pixel, tile[i], m);
      }
      float* out = to + k * stride + p;
      if (n == kPlaneTile && m == kPlaneTile) {
        transpose_tile(tile, out, stride);
        continue;
      }
      for (std::size_t j = 0; j < m; ++j)
        for (std::size_t i = 0; i < n; ++i) out[j * stride + i] = tile[i][j];
    }
  }
}

}  // namespace kiloband
