#include "stats/scale_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/distributions.hpp"
#include "stats/random.hpp"

namespace kiloband::stats {
namespace {

WorstUnit describe(const UnitPlace& place, const Contrast& contrast, const Strongest& strongest, double p) {
  const std::size_t c = strongest.channel;
  WorstUnit worst{place, c, contrast.a[c], contrast.b[c], contrast.difference[c]};
  worst.standard_error = std::sqrt(contrast.variance[c]);
  worst.t = strongest.t;
  worst.dof = contrast.dof[c];
  worst.p = p;
  return worst;
}

}  // namespace

void set_sides(const Contrast& contrast, std::size_t channel, RelativeError& error) {
  error.share = static_cast<float>(contrast.share[channel]);
  error.dof_a = static_cast<float>(contrast.dof_a);
  error.dof_b = static_cast<float>(contrast.dof_b);
}

ScaleTest::ScaleTest(uint32_t columns, uint32_t rows, uint64_t seed) : seed_(seed) {
  result_.columns = columns;
  result_.rows = rows;
  result_.t_map.assign(std::size_t{columns} * rows, std::numeric_limits<float>::quiet_NaN());
}

// The unit's p lies between that of its strongest channel and the Bonferroni bound: the rotations are needed
// only for units that may be the worst.
void ScaleTest::add(std::ptrdiff_t index, const UnitPlace& place, const Contrast& contrast,
                    const std::vector<bool>& wanted) {
  if (!contrast.valid) {
    result_.entries.unsampled += contrast.channels;
    return;
  }
  const Strongest strongest = strongest_channel(contrast, wanted);
  result_.entries.tested += strongest.tested;
  result_.entries.constant += strongest.constant;
  map(index, strongest);
  if (strongest.tested + strongest.constant == 0) return;
  if (strongest.tested > 0) {
    ++result_.units;
    result_.pooled_units += place.pooled;
    add_errors(contrast, wanted);
  }
  if (strongest.p >= best_p_) return;
  const double p = max_t_p(contrast, wanted, strongest, mix_seed(seed_, result_.units));
  if (p >= best_p_) return;
  best_p_ = p;
  result_.worst = describe(place, contrast, strongest, p);
}

void ScaleTest::map(std::ptrdiff_t index, const Strongest& strongest) {
  if (index < 0 || strongest.tested + strongest.constant == 0) return;
  result_.t_map[static_cast<std::size_t>(index)] = static_cast<float>(strongest.t);
}

void ScaleTest::add_errors(const Contrast& contrast, const std::vector<bool>& wanted) {
  std::vector<RelativeError> errors;
  for (std::size_t c = 0; c < contrast.channels; ++c) {
    if ((!wanted.empty() && !wanted[c]) || contrast.constant(c) || contrast.a[c] == 0) continue;
    const double mean = std::abs(contrast.a[c]);
    errors.push_back({static_cast<float>(std::sqrt(contrast.variance[c]) / mean),
                      static_cast<float>(contrast.slack[c] / mean), static_cast<float>(contrast.dof[c]),
                      static_cast<uint32_t>(c)});
    if (!contrast.share.empty()) set_sides(contrast, c, errors.back());
  }
  if (errors.empty()) return;
  for (const RelativeError& error : errors) result_.errors.add_value(error);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::ranges::nth_element(errors, middle, {}, &RelativeError::error);
  result_.errors.add(*middle, *middle);
}

ScaleResult ScaleTest::finish() {
  if (best_p_ <= 1)
    result_.p = sidak(best_p_, static_cast<double>(std::max<std::size_t>(1, result_.units) + left_));
  return std::move(result_);
}

}  // namespace kiloband::stats
