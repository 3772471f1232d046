// Products of spectra.
#include <algorithm>
#include <cmath>
#include <queue>

#include "spectral/quadrature.hpp"
#include "spectral/spectrum_node.hpp"

namespace kiloband {
namespace {

ValueBounds multiply(const ValueBounds& a, const ValueBounds& b) {
  const auto [min, max] = std::minmax({a.min * b.min, a.min * b.max, a.max * b.min, a.max * b.max});
  return {min, max};
}

/// Part of the interval and an upper bound of sign * product there.
struct Part {
  double a, b, upper;
  bool operator<(const Part& other) const { return upper < other.upper; }
};

/// Least upper bound of sign * product, by branch and bound: the part with the largest upper bound is halved
/// until it exceeds the largest value seen by no more than 1e-3 of it. The result bounds from above even if
/// that takes too long.
double search_maximum(const ProductNode& product, const std::vector<double>& breaks, double sign) {
  constexpr int kMaxSplits = 20000;
  constexpr double kRelative = 1e-3;
  std::priority_queue<Part> parts;
  double seen = -std::numeric_limits<double>::infinity(), magnitude = 0;
  const auto add = [&](double a, double b) {
    const ValueBounds bounds = product.enclosure(a, b);
    parts.push({a, b, sign > 0 ? bounds.max : -bounds.min});
    seen = std::max({seen, sign * product.value(a), sign * product.value(b)});
    magnitude = std::max({magnitude, std::abs(bounds.min), std::abs(bounds.max)});
  };
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) add(breaks[i], breaks[i + 1]);
  if (parts.empty()) return sign * product.value(breaks.front());
  for (int split = 0; split < kMaxSplits; ++split) {
    const Part top = parts.top();
    const double middle = 0.5 * (top.a + top.b);
    if (top.upper <= seen + kRelative * std::abs(seen) + 1e-13 * magnitude) break;
    if (!(top.a < middle && middle < top.b)) break;
    parts.pop();
    add(top.a, middle);
    add(middle, top.b);
  }
  return parts.top().upper;
}

}  // namespace

double ProductNode::value(double lambda_nm) const {
  double result = 1;
  for (const Pointer& factor : factors_) result *= factor->value(lambda_nm);
  return result;
}

void ProductNode::evaluate(std::span<const double> lambda_nm, std::span<double> out) const {
  factors_.front()->evaluate(lambda_nm, out);
  std::vector<double> other(lambda_nm.size());
  for (std::size_t f = 1; f < factors_.size(); ++f) {
    factors_[f]->evaluate(lambda_nm, other);
    for (std::size_t i = 0; i < other.size(); ++i) out[i] *= other[i];
  }
}

ValueBounds ProductNode::enclosure(double min_nm, double max_nm) const {
  ValueBounds result = factors_.front()->enclosure(min_nm, max_nm);
  for (std::size_t f = 1; f < factors_.size(); ++f)
    result = multiply(result, factors_[f]->enclosure(min_nm, max_nm));
  return result;
}

ValueBounds ProductNode::bounds(double min_nm, double max_nm) const {
  const std::vector<double> points = breaks(min_nm, max_nm);
  return {-search_maximum(*this, points, -1), search_maximum(*this, points, 1)};
}

double ProductNode::integral(double min_nm, double max_nm) const {
  return integrate([this](double lambda_nm) { return value(lambda_nm); }, breaks(min_nm, max_nm),
                   kSpectrumTolerance);
}

void ProductNode::append_breaks(double min_nm, double max_nm, std::vector<double>& out) const {
  for (const Pointer& factor : factors_) factor->append_breaks(min_nm, max_nm, out);
}

Spectrum::Node::Pointer ProductNode::scaled(double factor) const {
  std::vector<Pointer> factors = factors_;
  factors.front() = factors.front()->scaled(factor);
  return std::make_shared<ProductNode>(std::move(factors));
}

Spectrum::Node::Pointer ProductNode::extrapolated() const {
  std::vector<Pointer> factors = factors_;
  for (Pointer& factor : factors)
    if (Pointer extrapolated = factor->extrapolated()) factor = std::move(extrapolated);
  return std::make_shared<ProductNode>(std::move(factors));
}

bool ProductNode::is_constant() const {
  return std::all_of(factors_.begin(), factors_.end(),
                     [](const Pointer& factor) { return factor->is_constant(); });
}

/// Whether the product is 0 outside a range: a factor has data that are not continued.
bool ProductNode::is_cut_off() const {
  return std::any_of(factors_.begin(), factors_.end(), [](const Pointer& factor) {
    return factor->data_range().has_value() && !factor->extrapolates();
  });
}

// Factors that are continued have values wherever others have data. Disjoint ranges: a single point, outside of
// which the product is 0.
std::optional<Spectrum::Range> ProductNode::data_range() const {
  const bool cut_off = is_cut_off();
  std::optional<Spectrum::Range> result;
  for (const Pointer& factor : factors_) {
    const std::optional<Spectrum::Range> range = factor->data_range();
    if (!range || (cut_off && factor->extrapolates())) continue;
    if (!result) result = range;
    result = {{std::max(result->min_nm, range->min_nm), std::min(result->max_nm, range->max_nm)}};
  }
  if (result) result->max_nm = std::max(result->min_nm, result->max_nm);
  return result;
}

bool ProductNode::extrapolates() const {
  return data_range().has_value() && !is_cut_off();
}

// A product of continued factors varies as long as one of them does.
std::optional<Spectrum::Range> ProductNode::varying_range() const {
  if (is_cut_off()) return data_range();
  std::optional<Spectrum::Range> result;
  for (const Pointer& factor : factors_) {
    const std::optional<Spectrum::Range> range = factor->varying_range();
    if (!range) return std::nullopt;
    if (!result) result = range;
    result = {{std::min(result->min_nm, range->min_nm), std::max(result->max_nm, range->max_nm)}};
  }
  return result;
}

}  // namespace kiloband
