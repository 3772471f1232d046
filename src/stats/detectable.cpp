#include "stats/detectable.hpp"

#include <algorithm>
#include <limits>

#include "stats/distributions.hpp"

namespace kiloband::stats {
namespace {

double bias_of(const RelativeError& e, double one_level) {
  return e.slack + e.error * (student_upper(one_level / 2, e.dof) + student_upper(1 - kPower, e.dof));
}

}  // namespace

void DetectableBias::add(RelativeError median, RelativeError largest) {
  medians_.push_back(median);
  if (medians_.size() == 1 || largest.error > largest_.error) largest_ = largest;
}

Detectable DetectableBias::at(double level, double tests) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (medians_.empty()) return {kNone, kNone, kNone, 0};
  std::vector<RelativeError> sorted = medians_;
  std::ranges::sort(sorted, {}, &RelativeError::error);
  const double one = std::min(0.5, level / std::max(1.0, tests));
  return {bias_of(sorted[sorted.size() / 2], one), bias_of(sorted.front(), one), bias_of(largest_, one),
          largest_.channel};
}

}  // namespace kiloband::stats
