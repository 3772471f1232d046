#include "stats/distributions.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numbers>
#include <vector>

namespace kiloband::stats {
namespace {

/// In double itself: with long double, Boost's usual, comparisons take twice as long. Differs from it by at
/// most 3e-9 for p near 1, 3e-13 in the tails, and in quantiles down to kSmallestFast by 2e-15; quantiles of
/// yet smaller tails may be wrong by half, or throw.
using FastStudentsT = boost::math::students_t_distribution<
    double, boost::math::policies::policy<boost::math::policies::promote_double<false>>>;
constexpr double kSmallestFast = 1e-60;

}  // namespace

double student_p(double t, double dof) {
  if (std::isinf(t)) return 0;
  return std::min(1.0, 2 * boost::math::cdf(boost::math::complement(FastStudentsT(dof), std::abs(t))));
}

double student_upper(double p, double dof) {
  if (p >= kSmallestFast) return boost::math::quantile(boost::math::complement(FastStudentsT(dof), p));
  return boost::math::quantile(boost::math::complement(boost::math::students_t(dof), p));
}

// With independent chi^2 variables X_a, X_b the sum is normal of variance share dof_a / X_a + (1 - share)
// dof_b / X_b, given these. B = X_a / (X_a + X_b) has a Beta distribution and does not depend on X_a + X_b,
// so that
//     P = E_B P(|T| >= t / f(B)),   f(B)^2 = (share dof_a / B + (1 - share) dof_b / (1 - B)) / (dof_a + dof_b),
// with Student's T of dof_a + dof_b degrees of freedom (Ray and Pitman, J. Roy. Stat. Soc. B 23, 1961).
// Summed over y = ln(B / (1 - B)), in which all is smooth, by the trapezoidal rule; the ends reach where a t
// so large comes from.
double behrens_fisher_p(double t, double share, double dof_a, double dof_b) {
  constexpr double kNormal = 1e8;  // infinitely many degrees of freedom
  const double a = std::min(dof_a, kNormal), b = std::min(dof_b, kNormal), x = std::abs(t);
  if (std::isinf(x) || (std::isinf(dof_a) && std::isinf(dof_b))) return student_p(t, dof_a);
  const double width = std::sqrt(2 / a + 2 / b), middle = std::log(a / b), beyond = 2 * std::log1p(x);
  const double first = std::min(middle - 12 * width, -beyond - std::log1p(b / a)) - 80 / a;
  const double last = std::max(middle + 12 * width, beyond + std::log1p(a / b)) + 80 / b;
  const auto steps = static_cast<int>(std::ceil((last - first) / std::min(0.5, width / 6)));
  const auto log_weight = [&](double y) {
    return -0.5 * a * std::log1p(std::exp(-y)) - 0.5 * b * std::log1p(std::exp(y));
  };
  const double largest = log_weight(middle);
  double sum = 0, weights = 0;
  for (int i = 0; i <= steps; ++i) {
    const double y = first + (last - first) * i / steps;
    const double weight = std::exp(log_weight(y) - largest);
    if (weight == 0) continue;
    const double f =
        std::sqrt((share * a * (1 + std::exp(-y)) + (1 - share) * b * (1 + std::exp(y))) / (a + b));
    sum += weight * student_p(x / f, a + b);
    weights += weight;
  }
  return std::min(1.0, sum / weights);
}

// P(T >= t) = E_X Phi(delta - t sqrt(X / dof)), summed over ln X, as above. delta / t lies between sqrt(X /
// dof) for the smallest and the largest X that occur.
double noncentral_shift(double t, double dof, double p) {
  const double n = std::min(dof, 1e8), width = std::sqrt(2 / n);
  const double first = std::log(n) - 12 * width - 80 / n, last = std::log(n) + 12 * width;
  const auto steps = static_cast<int>(std::ceil((last - first) / std::min(0.1, width / 10)));
  std::vector<double> scales, weights;
  double total = 0;
  for (int i = 0; i <= steps; ++i) {
    const double y = first + (last - first) * i / steps;
    scales.push_back(t * std::exp(0.5 * (y - std::log(n))));
    weights.push_back(std::exp(0.5 * (n * (y - std::log(n)) - std::exp(y) + n)));
    total += weights.back();
  }
  double low = 0, high = 10 + scales.back();
  for (int k = 0; k < 36; ++k) {  // to 1e-9 of it
    const double delta = 0.5 * (low + high);
    double above = 0;
    for (std::size_t i = 0; i < scales.size(); ++i)
      above += weights[i] * 0.5 * std::erfc((scales[i] - delta) * std::numbers::sqrt2 / 2);
    (above < p * total ? low : high) = delta;
  }
  return high;
}

// Two series for the same function: the first converges at once for large x, the second for small x.
double kolmogorov_p(double x) {
  if (x <= 0) return 1;
  double sum = 0;
  if (x > 1) {
    for (int k = 1; k <= 20; ++k) sum += (k % 2 == 1 ? 2 : -2) * std::exp(-2.0 * k * k * x * x);
    return std::clamp(sum, 0.0, 1.0);
  }
  constexpr double kPi = 3.14159265358979323846;
  for (int k = 1; k <= 39; k += 2) sum += std::exp(-k * k * kPi * kPi / (8 * x * x));
  return std::clamp(1 - std::sqrt(2 * kPi) / x * sum, 0.0, 1.0);
}

double sidak(double p, double tests) {
  return p >= 1 ? 1 : -std::expm1(tests * std::log1p(-p));
}

}  // namespace kiloband::stats
