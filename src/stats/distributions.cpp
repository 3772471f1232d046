#include "stats/distributions.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace kiloband::stats {

double student_p(double t, double dof) {
  if (std::isinf(t)) return 0;
  return std::min(1.0,
                  2 * boost::math::cdf(boost::math::complement(boost::math::students_t(dof), std::abs(t))));
}

double student_upper(double p, double dof) {
  return boost::math::quantile(boost::math::complement(boost::math::students_t(dof), p));
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
