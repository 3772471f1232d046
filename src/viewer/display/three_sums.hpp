// Three weighted sums of the same values, by the vectors of the processor at hand.
#pragma once

#include <array>
#include <cstddef>

namespace kiloband::viewer {

/// out[c] = sum over k of weights[c][k] * values[k], c = 0, 1, 2, in single precision; the order of the additions depends on the
/// instruction set, so the last bits do.
/// weights, values  `count` numbers each
void three_sums(const std::array<const float*, 3>& weights, const float* values, std::size_t count,
                float* out);

}  // namespace kiloband::viewer
