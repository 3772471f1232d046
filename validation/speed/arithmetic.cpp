#include "validation/speed/arithmetic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiloband::speed {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Estimate median_of(std::vector<double> values) {
  if (values.empty()) return {kNan, kNan};
  std::ranges::sort(values);
  const std::size_t n = values.size();
  const double median = n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
  return {median, n < 2 ? kNan : 0.5 * (values.back() - values.front())};
}

Estimate mean_of(const std::vector<double>& values) {
  if (values.empty()) return {kNan, kNan};
  const auto n = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, values.size() < 2 ? kNan : std::sqrt(squares / (n - 1) / n)};
}

Estimate without_reference(const std::vector<double>& squares, const Estimate& reference) {
  const Estimate mean = mean_of(squares);
  return {mean.value - reference.value, std::hypot(mean.error, reference.error)};
}

Estimate root_of(const Estimate& square) {
  if (!(square.value > 0)) return {kNan, kNan};
  const double root = std::sqrt(square.value);
  return {root, 0.5 * square.error / root};
}

Estimate efficiency_of(const Estimate& square, const Estimate& seconds) {
  if (!(square.value > 0) || !(seconds.value > 0)) return {kNan, kNan};
  const double value = 1 / (square.value * seconds.value);
  return {value, value * std::hypot(square.error / square.value, seconds.error / seconds.value)};
}

Estimate ratio_of(const Estimate& a, const Estimate& b) {
  const double value = a.value / b.value;
  return {value, std::abs(value) * std::hypot(a.error / a.value, b.error / b.value)};
}

}  // namespace kiloband::speed
