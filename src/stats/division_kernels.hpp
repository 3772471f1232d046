// Units under a division of their replicates, many at a time: compiled for SSE4.2, AVX2 and AVX-512. Products and sums are rounded one by
// one: every instruction set gives the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kiloband::stats {

/// Units of a block, whose values stay in the first cache.
inline constexpr std::size_t kBlockUnits = 32;

/// D and V of divisions.hpp as forms of s and q: a = half s, D = of_difference |a|, V = of_one + of_q q - of_squares a^2.
struct DividedForms {
  float half, of_difference, of_one, of_q, of_squares;
  std::size_t replicates;
  bool needs_q;  // else q is taken for 0
};

/// Cell of u = t^2 / (t^2 + 4) of each unit, t = (D - slack) / sqrt(V): floor(cells u), at most cells - 1.
/// values  [replicate][unit]
/// division  [replicate] 1 or -1
/// slack  [unit]
void find_cells(const DividedForms& forms, const float* values, const float* division, const float* slack,
                uint32_t cells, uint32_t (&cell)[kBlockUnits]);

}  // namespace kiloband::stats
