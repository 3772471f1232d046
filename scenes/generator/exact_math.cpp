#include "scenes/generator/exact_math.hpp"

#include <cmath>
#include <cstdint>

namespace kiloband::generator {
namespace {

/// Taylor series on |r| <= pi/4: the first term left out is below 1e-17.
double sine_series(double r) {
  const double r2 = r * r;
  double sum = 0;
  for (int n = 17; n >= 3; n -= 2) sum = (1 + sum) * (-r2 / (n * (n - 1)));
  return r * (1 + sum);
}

double cosine_series(double r) {
  const double r2 = r * r;
  double sum = 0;
  for (int n = 18; n >= 2; n -= 2) sum = (1 + sum) * (-r2 / (n * (n - 1)));
  return 1 + sum;
}

/// sin(x + quarters * pi/2): pi/2 in two parts, so that the reduction keeps its digits.
double sine_quarters(double x, int quarters) {
  constexpr double kHigh = 1.57079632673412561417, kLow = 6.07710050650619224932e-11;
  const double n = std::floor(x * (2 / kPi) + 0.5);
  const double r = (x - n * kHigh) - n * kLow;
  const auto q = (static_cast<std::int64_t>(n) + quarters) & 3;
  const double value = (q & 1) ? cosine_series(r) : sine_series(r);
  return (q & 2) ? -value : value;
}

/// arctan t for t in [0, 1]: halved three times, tan(a/2) = t / (1 + sqrt(1 + t^2)).
double arctangent_unit(double t) {
  for (int i = 0; i < 3; ++i) t = t / (1 + std::sqrt(1 + t * t));
  const double t2 = t * t;
  double sum = 0;
  for (int n = 23; n >= 1; n -= 2) sum = 1.0 / n - t2 * sum;
  return 8 * t * sum;
}

}  // namespace

double sine(double x) {
  return sine_quarters(x, 0);
}

double cosine(double x) {
  return sine_quarters(x, 1);
}

double arctangent(double y, double x) {
  const double ax = std::fabs(x), ay = std::fabs(y);
  if (ax == 0 && ay == 0) return 0;
  double angle = ay <= ax ? arctangent_unit(ay / ax) : kPi / 2 - arctangent_unit(ax / ay);
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

double exponential(double x) {
  constexpr double kHigh = 6.93147180369123816490e-01, kLow = 1.90821492927058770002e-10;
  const double n = std::floor(x / (kHigh + kLow) + 0.5);
  const double r = (x - n * kHigh) - n * kLow;
  double sum = 1;
  for (int i = 16; i >= 1; --i) sum = 1 + sum * (r / i);
  return std::ldexp(sum, static_cast<int>(n));
}

double logarithm(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752) {
    m *= 2;
    --exponent;
  }
  // ln m = 2 artanh((m - 1) / (m + 1)), |s| < 0.172
  const double s = (m - 1) / (m + 1), s2 = s * s;
  double sum = 0;
  for (int n = 25; n >= 1; n -= 2) sum = 1.0 / n + s2 * sum;
  return 2 * s * sum + exponent * 0.69314718055994531;
}

double power(double base, double exponent) {
  return base <= 0 ? 0 : exponential(exponent * logarithm(base));
}

double smooth_step(double a, double b, double x) {
  const double t = clamp((x - a) / (b - a), 0, 1);
  return t * t * (3 - 2 * t);
}

double mix(double a, double b, double t) {
  return a + (b - a) * t;
}

double clamp(double x, double low, double high) {
  return x < low ? low : x > high ? high : x;
}

double random_number(unsigned seed, unsigned counter) {
  std::uint64_t h = (std::uint64_t{seed} << 32) + counter + 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
  h ^= h >> 33;
  return static_cast<double>(h >> 11) * 0x1p-53;
}

}  // namespace kiloband::generator
