#include "stats/detectable.hpp"

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

#include "stats/distributions.hpp"

namespace kiloband::stats {
namespace {

constexpr double kLeastP = 1e-300;

/// The |t| from which on the test says that there is a difference, to six digits.
double critical_t(const RelativeError& e, double one_level) {
  const double least = student_upper(one_level / 2, e.dof);
  if (e.share < 0) return least;
  // BF's law lies between Student's of Welch's and of the smaller dof, and p is nearly a power of t.
  const double most = student_upper(one_level / 2, std::min(e.dof_a, e.dof_b));
  const auto excess = [&](double log_t) {
    // At the far end of few replicates p may be 0 in double, whose logarithm the search cannot use.
    const double p = std::max(behrens_fisher_p(std::exp(log_t), e.share, e.dof_a, e.dof_b), kLeastP);
    return std::log(p / one_level);
  };
  const double low = std::log(least), high = std::log(most), at_low = excess(low);
  const double at_high = at_low > 0 ? excess(high) : 0;
  if (!(at_low > 0)) return least;
  if (!(at_high < 0)) return most;
  const auto close = [](double a, double b) { return std::abs(b - a) < 1e-6; };
  std::uintmax_t evaluations = 30;
  const auto found =
      boost::math::tools::toms748_solve(excess, low, high, at_low, at_high, close, evaluations);
  return std::exp(found.second);
}

double bias_of(const RelativeError& e, double one_level) {
  return e.slack + e.error * noncentral_shift(critical_t(e, one_level), e.dof, kPower);
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
