// Sigmoid and Planck spectra.
#include <algorithm>
#include <cmath>

#include "spectral/colour/colour.hpp"
#include "spectral/planck.hpp"
#include "spectral/quadrature.hpp"
#include "spectral/spectrum_node.hpp"

namespace kiloband {
namespace {

/// Wien's displacement constant, nm K (CODATA 2018).
constexpr double kWien_nm_k = 2.897771955e6;

ValueBounds ordered(double a, double b) {
  return {std::min(a, b), std::max(a, b)};
}

/// Roots of a x^2 + b x + c, without cancellation; none for a constant.
std::vector<double> quadratic_roots(double a, double b, double c) {
  if (a == 0) return b == 0 ? std::vector<double>{} : std::vector<double>{-c / b};
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0)) return {};
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  if (q == 0) return {0};
  return {q / a, c / q};
}

}  // namespace

double SigmoidNode::value(double lambda_nm) const {
  const double x = std::clamp(lambda_nm, kCieMinNm, kCieMaxNm);
  const double v = (c_[0] * x + c_[1]) * x + c_[2];
  return scale_ * (0.5 + 0.5 * v / std::sqrt(1 + v * v));
}

// S is monotonic in v, and v is a parabola: extremes at the ends or at its vertex.
ValueBounds SigmoidNode::enclosure(double min_nm, double max_nm) const {
  ValueBounds result = ordered(value(min_nm), value(max_nm));
  const double vertex_nm = -c_[1] / (2 * c_[0]);
  if (c_[0] != 0 && vertex_nm > min_nm && vertex_nm < max_nm) {
    const double v = value(vertex_nm);
    result = {std::min(result.min, v), std::max(result.max, v)};
  }
  return result;
}

double SigmoidNode::integral(double min_nm, double max_nm) const {
  if (is_constant()) return value(min_nm) * (max_nm - min_nm);
  return integrate([this](double lambda_nm) { return value(lambda_nm); }, breaks(min_nm, max_nm),
                   kSpectrumTolerance);
}

// Kinks at the ends of 360-830 nm, the vertex, the roots (steepest slope), and where the shoulders of a steep
// edge are (v = -8, 8): a narrow band cannot hide between quadrature or resampling points.
void SigmoidNode::append_breaks(double min_nm, double max_nm, std::vector<double>& out) const {
  std::vector<double> points = {kCieMinNm, kCieMaxNm};
  if (c_[0] != 0) points.push_back(-c_[1] / (2 * c_[0]));
  for (const double level : {-8.0, -1.0, 0.0, 1.0, 8.0})
    for (const double root : quadratic_roots(c_[0], c_[1], c_[2] - level)) points.push_back(root);
  for (const double point : points)
    if (point >= kCieMinNm && point <= kCieMaxNm && point > min_nm && point < max_nm) out.push_back(point);
}

std::optional<Spectrum::Range> SigmoidNode::data_range() const {
  return {{kCieMinNm, kCieMaxNm}};
}

double PlanckNode::value(double lambda_nm) const {
  if (!(lambda_nm > 0)) return 0;
  if (range_ && !(lambda_nm >= range_->min_nm && lambda_nm <= range_->max_nm)) return 0;
  return scale_ * planck_radiance(lambda_nm, temperature_k_);
}

std::optional<Spectrum::Range> PlanckNode::inside(double min_nm, double max_nm) const {
  const double lower_nm = range_ ? range_->min_nm : 0;
  min_nm = std::max({min_nm, lower_nm, 1e-6});  // at no temperature is there radiation below 1 femtometre
  if (range_) max_nm = std::min(max_nm, range_->max_nm);
  if (!(min_nm <= max_nm)) return std::nullopt;
  return {{min_nm, max_nm}};
}

double PlanckNode::peak_nm() const {
  return kWien_nm_k / temperature_k_;
}

// Planck's law rises to its peak and falls after it.
ValueBounds PlanckNode::enclosure(double min_nm, double max_nm) const {
  const std::optional<Spectrum::Range> part = inside(min_nm, max_nm);
  if (!part || temperature_k_ == 0) return {0, 0};
  ValueBounds result = ordered(value(part->min_nm), value(part->max_nm));
  const auto include = [&](double v) { result = {std::min(result.min, v), std::max(result.max, v)}; };
  if (peak_nm() > part->min_nm && peak_nm() < part->max_nm) include(value(peak_nm()));
  if (part->min_nm > min_nm || part->max_nm < max_nm) include(0);
  return result;
}

double PlanckNode::integral(double min_nm, double max_nm) const {
  const std::optional<Spectrum::Range> part = inside(min_nm, max_nm);
  return part ? scale_ * planck_integral(part->min_nm, part->max_nm, temperature_k_) : 0;
}

void PlanckNode::append_breaks(double min_nm, double max_nm, std::vector<double>& out) const {
  std::vector<double> points;
  if (range_) points = {range_->min_nm, range_->max_nm};
  // The peak with its flanks: with them a wide interval does not miss a narrow peak.
  if (temperature_k_ > 0)
    for (const double multiple : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0})
      points.push_back(multiple * peak_nm());
  for (const double point : points)
    if (point > min_nm && point < max_nm) out.push_back(point);
}

Spectrum::Node::Pointer PlanckNode::scaled(double factor) const {
  return std::make_shared<PlanckNode>(temperature_k_, scale_ * factor, range_);
}

}  // namespace kiloband
