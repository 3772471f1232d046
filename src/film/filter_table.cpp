#include "film/filter_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kiloband {
namespace {

constexpr double kLeastRatio = 1e-2;
constexpr double kLargestRatio = 30;

double gaussian_tail(double x, double r) {
  const double root_half_pi = 1.2533141373155003;
  const double sqrt_half = 0.70710678118654752;
  return root_half_pi * (std::erfc(x * sqrt_half) - std::erfc(r * sqrt_half)) -
         (r - x) * std::exp(-0.5 * r * r);
}

double gaussian_density(double x, double r) {
  return std::exp(-0.5 * x * x) - std::exp(-0.5 * r * r);
}

/// Steeper than three times the secant of its piece, a falling cubic would turn back (Fritsch, Carlson 1980).
void keep_monotone(std::vector<KbFloat2>& nodes) {
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    const float steepest = 3 * (nodes[i + 1].x - nodes[i].x);
    nodes[i].y = std::max(nodes[i].y, steepest);
    nodes[i + 1].y = std::max(nodes[i + 1].y, steepest);
  }
}

}  // namespace

double invert_gaussian_tail(double w, double r) {
  // Newton's method kept inside a bracket.
  const double target = w * gaussian_tail(0, r);
  double low = 0, high = r;
  double x = 0.5 * r;
  for (int i = 0; i < 100 && high - low > 1e-13 * r; ++i) {
    const double excess = gaussian_tail(x, r) - target;
    (excess > 0 ? low : high) = x;
    const double next = x + excess / gaussian_density(x, r);
    const bool inside = next > low && next < high;  // false for NaN too
    const double step = inside ? next - x : 0.5 * (low + high) - x;
    x += step;
    if (inside && std::fabs(step) < 1e-13 * r) break;
  }
  return x;
}

std::vector<KbFloat2> make_gaussian_filter_table(double ratio) {
  if (!(ratio > 0)) throw std::logic_error("make_gaussian_filter_table: radius / stddev must be > 0");
  // Below the least ratio the filter is a parabola, the same for all but its width;
  // above the largest nothing is cut off.
  if (ratio < kLeastRatio) {
    std::vector<KbFloat2> nodes = make_gaussian_filter_table(kLeastRatio);
    const auto scale = static_cast<float>(ratio / kLeastRatio);
    for (KbFloat2& node : nodes) node = {node.x * scale, node.y * scale};
    return nodes;
  }
  ratio = std::min(ratio, kLargestRatio);
  std::vector<KbFloat2> nodes;
  nodes.reserve(kFilterPieces + 1);
  const double total = gaussian_tail(0, ratio);
  for (int i = 0; i <= kFilterPieces; ++i) {
    const double q = static_cast<double>(i) / kFilterPieces;
    const double x = invert_gaussian_tail(q * q, ratio);
    // dx/dq = -2 q G(0) / f(x); at the end of the support f = r e^(-r^2/2) (r - x),
    // w G(0) = r e^(-r^2/2) (r - x)^2 / 2.
    const double edge = ratio * std::exp(-0.5 * ratio * ratio);
    const double slope = i == 0 ? -std::sqrt(2 * total / edge) : -2 * q * total / gaussian_density(x, ratio);
    nodes.push_back({static_cast<float>(x), static_cast<float>(slope / kFilterPieces)});
  }
  keep_monotone(nodes);
  return nodes;
}

}  // namespace kiloband
