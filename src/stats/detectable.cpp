#include "stats/detectable.hpp"

#include <algorithm>
#include <bit>
#include <boost/math/distributions/chi_squared.hpp>
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

/// A class of values: eighths of a power of two of what the critical t depends on.
uint64_t class_of(const RelativeError& e) {
  const auto eighth = [](float x) { return uint64_t{std::bit_cast<uint32_t>(x) >> 20}; };
  return eighth(e.share / (1 - e.share)) << 36 | eighth(e.dof_a) << 24 | eighth(e.dof_b) << 12 |
         eighth(e.dof);
}

double fewest_dof(const RelativeError& e) {
  return e.share < 0 ? e.dof : std::min(e.dof_a, e.dof_b);
}

/// Whether bias_of() may be above `bias`, by a fortieth of the work. With X of chi^2 and its 95 % quantile
/// x, the shift t sqrt(x / dof) + 1.645 is missed by Z or by X, with probability 0.05 each: the bias is not
/// above that of a t which it takes from here, unless p is above the level there.
bool may_exceed(const RelativeError& e, double one_level, double bias) {
  const double dof = std::min<double>(e.dof, 1e8);
  const double x = boost::math::quantile(boost::math::chi_squared(dof), 0.95);
  const double t = ((bias - e.slack) / e.error - 1.645) / std::sqrt(x / dof);
  if (!(t > 0)) return true;
  return (e.share < 0 ? student_p(t, e.dof) : behrens_fisher_p(t, e.share, e.dof_a, e.dof_b)) > one_level;
}

struct WorstBias {
  double bias = 0;
  std::size_t channel = 0;
};

/// Begins with the value that promises most: then few of the others are computed.
WorstBias worst_of(const std::unordered_map<uint64_t, RelativeError>& values, double one_level) {
  const auto promise = [&](const auto& of_class) {
    const RelativeError& e = of_class.second;
    return e.slack + e.error * student_upper(one_level / 2, fewest_dof(e));
  };
  const RelativeError& first = std::ranges::max_element(values, {}, promise)->second;
  WorstBias worst{bias_of(first, one_level), first.channel};
  for (const auto& [of_class, e] : values) {
    if (&e == &first || !may_exceed(e, one_level, worst.bias)) continue;
    const double bias = bias_of(e, one_level);
    if (bias > worst.bias) worst = {bias, e.channel};
  }
  return worst;
}

}  // namespace

void DetectableBias::add(RelativeError median, RelativeError value) {
  medians_.push_back(median);
  add_value(value);
}

void DetectableBias::add_value(const RelativeError& value) {
  const auto [place, is_new] = largest_.try_emplace(class_of(value), value);
  if (!is_new && value.error > place->second.error) place->second = value;
}

Detectable DetectableBias::at(double level, double tests) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (medians_.empty()) return {kNone, kNone, kNone, 0};
  std::vector<RelativeError> sorted = medians_;
  std::ranges::sort(sorted, {}, &RelativeError::error);
  const double one = std::min(0.5, level / std::max(1.0, tests));
  const WorstBias worst = worst_of(largest_, one);
  return {bias_of(sorted[sorted.size() / 2], one), bias_of(sorted.front(), one), worst.bias, worst.channel};
}

}  // namespace kiloband::stats
