#include "spectral/planck.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace kiloband {
namespace {

// CODATA 2018; h, c and k are exact in the SI.
constexpr double kPlanck = 6.62607015e-34;   // J s
constexpr double kLightSpeed = 299792458.0;  // m/s
/// 2 h c^2 in W m^-2 sr^-1 nm^-1 nm^5: 1e-9 per nm, (1e9)^5 from the metres of lambda^5.
constexpr double kFirst = 2.0 * kPlanck * kLightSpeed * kLightSpeed * 1e36;
constexpr double kSecond_nm_k = kPlanckSecond_nm_k;
/// exp(-x) is 0 in double from here on.
constexpr double kLargestExponent = 745.2;

// Gauss-Legendre rule with 16 points on [-1, 1], positive half (Abramowitz & Stegun, table 25.4).
constexpr std::array<double, 8> kGaussNodes = {
    0.0950125098376374402, 0.2816035507792589132, 0.4580167776572273863, 0.6178762444026437484,
    0.7554044083550030339, 0.8656312023878317439, 0.9445750230732325761, 0.9894009349916499326};
constexpr std::array<double, 8> kGaussWeights = {
    0.1894506104550684963, 0.1826034150449235888, 0.1691565193950025382, 0.1495959888165767320,
    0.1246289712555338720, 0.0951585116824927848, 0.0622535239386478929, 0.0271524594117540949};

/// Integral of lambda B over the logarithm of lambda from log_min to log_max, by one rule.
double integrate_panel(double log_min, double log_max, double temperature_k) {
  const double centre = 0.5 * (log_min + log_max), half = 0.5 * (log_max - log_min);
  double sum = 0;
  for (std::size_t i = 0; i < kGaussNodes.size(); ++i)
    for (const double t : {centre - half * kGaussNodes[i], centre + half * kGaussNodes[i]}) {
      const double lambda_nm = std::exp(t);
      sum += kGaussWeights[i] * lambda_nm * planck_radiance(lambda_nm, temperature_k);
    }
  return half * sum;
}

/// Narrow intervals: the logarithm of a wavelength would lose the digits of the width.
double integrate_narrow(double min_nm, double max_nm, double temperature_k) {
  const double centre_nm = 0.5 * (min_nm + max_nm), half_nm = 0.5 * (max_nm - min_nm);
  double sum = 0;
  for (std::size_t i = 0; i < kGaussNodes.size(); ++i)
    for (const double lambda_nm :
         {centre_nm - half_nm * kGaussNodes[i], centre_nm + half_nm * kGaussNodes[i]})
      sum += kGaussWeights[i] * planck_radiance(lambda_nm, temperature_k);
  return half_nm * sum;
}

}  // namespace

// exp(-x) / (1 - exp(-x)) instead of 1 / (exp(x) - 1): the latter overflows at x = 709 where B
// can still be 1e-288.
double planck_radiance(double lambda_nm, double temperature_k) {
  if (!(lambda_nm > 0) || !(temperature_k >= 0))
    throw std::logic_error("planck_radiance: wavelength must be positive and temperature not negative");
  if (temperature_k == 0) return 0;
  const double x = kSecond_nm_k / (lambda_nm * temperature_k);
  if (x > kLargestExponent) return 0;
  const double square = lambda_nm * lambda_nm;
  return kFirst / (square * square * lambda_nm) * (std::exp(-x) / -std::expm1(-x));
}

PlanckTerms planck_terms(double lambda_nm) {
  const double square = lambda_nm * lambda_nm;
  return {kFirst / (square * square * lambda_nm), kSecond_nm_k / lambda_nm};
}

// In t = ln(lambda) the integrand is lambda B; a panel may span 0.5 in t and 4 in x = c2 / (lambda T), over
// which a 16-point rule is exact to rounding (x and exp(-x) are entire functions of t).
double planck_integral(double min_nm, double max_nm, double temperature_k) {
  if (!(min_nm > 0) || !(max_nm >= min_nm) || !std::isfinite(max_nm) || !(temperature_k >= 0))
    throw std::logic_error(
        "planck_integral: interval must be ascending, positive and finite, temperature not negative");
  if (temperature_k == 0) return 0;
  const double underflow_nm = kSecond_nm_k / (temperature_k * kLargestExponent);
  min_nm = std::max(min_nm, std::min(underflow_nm, max_nm));
  if (min_nm >= max_nm) return 0;
  const double x_change = kSecond_nm_k / temperature_k * (1 / min_nm - 1 / max_nm);
  if (max_nm < 1.05 * min_nm && x_change < 4) return integrate_narrow(min_nm, max_nm, temperature_k);

  double sum = 0;
  const double log_end = std::log(max_nm);
  for (double t = std::log(min_nm); t < log_end;) {
    const double x = kSecond_nm_k / (temperature_k * std::exp(t));
    const double next = std::min(log_end, t + std::min(0.5, 4.0 / x));
    sum += integrate_panel(t, next, temperature_k);
    t = next;
  }
  return sum;
}

}  // namespace kiloband
