// Tables for choosing one of many items with a random number that is a multiple of 2^-24 (shared/sampler.h).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace kiloband {

/// The most items of a table: with 2^24 steps to deal out, each then has at least 4 on average.
inline constexpr std::size_t kMaxLatticeItems = std::size_t{1} << 22;

/// throws InputError at `position` ("what: ...") if there are more than kMaxLatticeItems
void check_lattice_items(std::size_t count, const SourcePosition& position, const std::string& what);

/// Cumulative distribution of `weights`, weights.size() + 1 entries from 0 to 1, all of them multiples of
/// 2^-24. Differences of entries are exact in float and are exactly the probabilities with which a random
/// multiple of 2^-24 in [0, 1) falls between them. Every positive weight has at least one step, however small
/// its part of the sum; a weight of 0 has none (if all are 0, the last item has everything).
/// weights  finite, >= 0, their sum finite
/// throws std::logic_error  an invalid weight, more than kMaxLatticeItems
std::vector<float> lattice_cdf(std::span<const double> weights);

}  // namespace kiloband
