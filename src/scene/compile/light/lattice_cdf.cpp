#include "scene/compile/light/lattice_cdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace kiloband {
namespace {

constexpr uint32_t kLatticeSteps = 1u << 24;  // floats are exact up to here

double checked_sum(std::span<const double> weights) {
  if (weights.size() > kMaxLatticeItems) throw std::logic_error("lattice_cdf: more items than steps allow");
  double sum = 0;
  for (const double w : weights) {
    if (!(w >= 0)) throw std::logic_error("lattice_cdf: weights must not be negative");
    sum += w;
  }
  if (!std::isfinite(sum)) throw std::logic_error("lattice_cdf: the sum of the weights must be finite");
  return sum;
}

}  // namespace

void check_lattice_items(std::size_t count, const SourcePosition& position, const std::string& what) {
  if (count <= kMaxLatticeItems) return;
  throw InputError(position, fmt::format("{}: {} are too many to choose one of by chance: at most {}", what,
                                         count, kMaxLatticeItems));
}

std::vector<float> lattice_cdf(std::span<const double> weights) {
  const double total = checked_sum(weights);
  const std::size_t count = weights.size();
  std::vector<uint32_t> steps(count + 1, 0);
  // Rounded running sums, pushed up where a positive weight would get nothing ...
  double sum = 0;
  for (std::size_t i = 0; i < count && total > 0; ++i) {
    sum += weights[i];
    const auto rounded = static_cast<uint32_t>(std::lround(std::min(sum / total, 1.0) * kLatticeSteps));
    steps[i + 1] = std::max(rounded, steps[i] + (weights[i] > 0 ? 1 : 0));
  }
  // ... and down from the end, where that went beyond 1.
  if (count > 0) steps[count] = kLatticeSteps;
  for (std::size_t i = count; i-- > 1;)
    steps[i] = std::min(steps[i], steps[i + 1] - (weights[i] > 0 ? 1 : 0));
  std::vector<float> cdf(count + 1);
  for (std::size_t i = 0; i <= count; ++i) cdf[i] = static_cast<float>(steps[i]) / kLatticeSteps;
  return cdf;
}

}  // namespace kiloband
