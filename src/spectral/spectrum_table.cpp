// Piecewise linear spectra.
#include <algorithm>

#include "spectral/spectrum_node.hpp"

namespace kiloband {

TableNode::TableNode(std::vector<double> lambda_nm, std::vector<double> values, bool extrapolate)
    : lambda_nm_(std::move(lambda_nm)), values_(std::move(values)), extrapolate_(extrapolate) {}

/// Value in segment [knot, knot + 1], both ends included and exact there.
double TableNode::inside(std::size_t segment, double lambda_nm) const {
  const double t = (lambda_nm - lambda_nm_[segment]) / (lambda_nm_[segment + 1] - lambda_nm_[segment]);
  return (1 - t) * values_[segment] + t * values_[segment + 1];
}

double TableNode::outside(double lambda_nm) const {
  if (!extrapolate_) return 0;
  return lambda_nm < lambda_nm_.front() ? values_.front() : values_.back();
}

double TableNode::value(double lambda_nm) const {
  if (!(lambda_nm >= lambda_nm_.front() && lambda_nm <= lambda_nm_.back())) return outside(lambda_nm);
  const auto above = std::upper_bound(lambda_nm_.begin(), lambda_nm_.end(), lambda_nm);
  if (above == lambda_nm_.end()) return values_.back();
  return inside(static_cast<std::size_t>(above - lambda_nm_.begin()) - 1, lambda_nm);
}

// Neighbouring wavelengths mostly fall into the same or the next segment: those are tried before searching.
void TableNode::evaluate(std::span<const double> lambda_nm, std::span<double> out) const {
  const std::size_t segments = lambda_nm_.size() - 1;
  std::size_t segment = 0;
  for (std::size_t i = 0; i < lambda_nm.size(); ++i) {
    const double lambda = lambda_nm[i];
    if (!(lambda >= lambda_nm_.front() && lambda <= lambda_nm_.back())) {
      out[i] = outside(lambda);
      continue;
    }
    if (segments == 0) {
      out[i] = values_.front();
      continue;
    }
    if (segment + 1 < segments && lambda > lambda_nm_[segment + 1]) ++segment;
    if (lambda < lambda_nm_[segment] || lambda > lambda_nm_[segment + 1]) {
      const auto above = std::upper_bound(lambda_nm_.begin(), lambda_nm_.end(), lambda);
      segment = std::min<std::size_t>(static_cast<std::size_t>(above - lambda_nm_.begin()) - 1, segments - 1);
    }
    out[i] = inside(segment, lambda);
  }
}

// A piecewise linear function has its extremes at knots and at the interval's ends, or outside the data.
ValueBounds TableNode::enclosure(double min_nm, double max_nm) const {
  const double left = value(min_nm), right = value(max_nm);
  ValueBounds result{std::min(left, right), std::max(left, right)};
  const auto include = [&](double v) { result = {std::min(result.min, v), std::max(result.max, v)}; };
  const auto first = std::lower_bound(lambda_nm_.begin(), lambda_nm_.end(), min_nm) - lambda_nm_.begin();
  const auto last = std::upper_bound(lambda_nm_.begin(), lambda_nm_.end(), max_nm) - lambda_nm_.begin();
  for (auto i = first; i < last; ++i) include(values_[static_cast<std::size_t>(i)]);
  return result;
}

// Trapezoids summed directly: differences of a running sum would lose the digits
// of small parts beside large ones.
double TableNode::integral(double min_nm, double max_nm) const {
  double sum = 0;
  if (extrapolate_ && min_nm < lambda_nm_.front())
    sum += values_.front() * (std::min(max_nm, lambda_nm_.front()) - min_nm);
  if (extrapolate_ && max_nm > lambda_nm_.back())
    sum += values_.back() * (max_nm - std::max(min_nm, lambda_nm_.back()));
  const auto above = std::upper_bound(lambda_nm_.begin(), lambda_nm_.end(), min_nm);
  std::size_t segment =
      above == lambda_nm_.begin() ? 0 : static_cast<std::size_t>(above - lambda_nm_.begin()) - 1;
  for (; segment + 1 < lambda_nm_.size() && lambda_nm_[segment] < max_nm; ++segment) {
    const double a = std::max(min_nm, lambda_nm_[segment]);
    const double b = std::min(max_nm, lambda_nm_[segment + 1]);
    if (a < b) sum += 0.5 * (b - a) * (inside(segment, a) + inside(segment, b));
  }
  return sum;
}

void TableNode::append_breaks(double min_nm, double max_nm, std::vector<double>& out) const {
  const auto first = std::upper_bound(lambda_nm_.begin(), lambda_nm_.end(), min_nm);
  const auto last = std::lower_bound(lambda_nm_.begin(), lambda_nm_.end(), max_nm);
  if (first < last) out.insert(out.end(), first, last);
}

Spectrum::Node::Pointer TableNode::scaled(double factor) const {
  std::vector<double> values = values_;
  for (double& value : values) value *= factor;
  return std::make_shared<TableNode>(lambda_nm_, std::move(values), extrapolate_);
}

Spectrum::Node::Pointer TableNode::extrapolated() const {
  return extrapolate_ ? nullptr : std::make_shared<TableNode>(lambda_nm_, values_, true);
}

}  // namespace kiloband
