#include "film/signed_filter.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace kiloband {
namespace {

constexpr auto kPieces = static_cast<std::size_t>(kFilterPieces);

double sinc(double x) {
  const double a = std::numbers::pi * x;
  return a < 1e-4 ? 1 - a * a / 6 : std::sin(a) / a;
}

/// The mean of f over [x, x + width]: Simpson's rule, exact for cubics.
double mean_of(const std::function<double(double)>& f, double x, double width) {
  return (f(x) + 4 * f(x + 0.5 * width) + f(x + width)) / 6;
}

}  // namespace

double mitchell(double x, double b, double c) {
  if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
  if (x >= 2) return 0;
  return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) /
         6;
}

double lanczos(double x, double radius) {
  return x < radius ? sinc(x) * sinc(x / radius) : 0;
}

SignedFilter make_signed_filter(const std::function<double(double)>& f, double radius) {
  SignedFilter filter;
  std::vector<double> means(kPieces), before(kPieces + 1);
  const double width = radius / kFilterPieces;
  double sum = 0;
  for (std::size_t i = 0; i < kPieces; ++i) {
    means[i] = mean_of(f, width * static_cast<double>(i), width);
    sum += means[i];
    before[i + 1] = before[i] + std::fabs(means[i]);
  }
  const double total = before[kPieces];
  if (!(sum > 1e-9 * total))
    throw std::logic_error("make_signed_filter: the filter's integral is not positive");
  for (const double p : before) filter.cells.push_back(static_cast<float>(p / total));
  for (const double mean : means) {
    filter.cells.push_back(mean < 0 ? -1.0f : 1.0f);
    filter.negative |= mean < 0;
  }
  filter.scale = (total / sum) * (total / sum);
  return filter;
}

}  // namespace kiloband
