#include "spectral/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/error.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/spectrum_node.hpp"

namespace kiloband {
namespace {

void require_finite(const char* what, double value) {
  if (!std::isfinite(value))
    throw InputError(std::string(what) + " " + format_number(value) + ": must be finite");
}

void require_interval(double min_nm, double max_nm) {
  if (!std::isfinite(min_nm) || !std::isfinite(max_nm) || min_nm > max_nm)
    throw std::logic_error("Spectrum: interval [" + format_number(min_nm) + ", " + format_number(max_nm) +
                           "] nm");
}

void check_table(const std::vector<double>& lambda_nm, const std::vector<double>& values) {
  if (lambda_nm.empty()) throw InputError("spectrum without data");
  if (lambda_nm.size() != values.size())
    throw InputError("spectrum: " + std::to_string(lambda_nm.size()) + " wavelengths but " +
                     std::to_string(values.size()) + " values");
  for (std::size_t i = 0; i < lambda_nm.size(); ++i) {
    require_finite("spectrum: wavelength", lambda_nm[i]);
    if (!std::isfinite(values[i]))
      throw InputError("spectrum: value " + format_number(values[i]) + " at " + format_number(lambda_nm[i]) +
                       " nm: must be finite");
    if (i > 0 && !(lambda_nm[i - 1] < lambda_nm[i]))
      throw InputError("spectrum: wavelength " + format_number(lambda_nm[i]) + " nm after " +
                       format_number(lambda_nm[i - 1]) + " nm: must increase strictly");
  }
}

/// Factors of a product, flat: those of a product are taken apart.
void append_factors(const std::shared_ptr<const Spectrum::Node>& node,
                    std::vector<std::shared_ptr<const Spectrum::Node>>& factors) {
  if (const auto* product = dynamic_cast<const ProductNode*>(node.get()))
    factors.insert(factors.end(), product->factors().begin(), product->factors().end());
  else
    factors.push_back(node);
}

}  // namespace

void Spectrum::Node::evaluate(std::span<const double> lambda_nm, std::span<double> out) const {
  for (std::size_t i = 0; i < lambda_nm.size(); ++i) out[i] = value(lambda_nm[i]);
}

std::vector<double> Spectrum::Node::breaks(double min_nm, double max_nm) const {
  std::vector<double> result = {min_nm, max_nm};
  append_breaks(min_nm, max_nm, result);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Spectrum::Spectrum(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

Spectrum::Spectrum() {
  static const std::shared_ptr<const Node> zero = std::make_shared<ConstantNode>(0.0);
  node_ = zero;
}

Spectrum Spectrum::constant(double value) {
  require_finite("spectrum: value", value);
  return Spectrum(std::make_shared<ConstantNode>(value));
}

Spectrum Spectrum::tabulated(std::vector<double> lambda_nm, std::vector<double> values, bool extrapolate) {
  check_table(lambda_nm, values);
  return Spectrum(std::make_shared<TableNode>(std::move(lambda_nm), std::move(values), extrapolate));
}

Spectrum Spectrum::sigmoid(const std::array<double, 3>& c, double scale) {
  for (const double coefficient : c) require_finite("sigmoid: coefficient", coefficient);
  require_finite("sigmoid: scale", scale);
  return Spectrum(std::make_shared<SigmoidNode>(c, scale));
}

Spectrum Spectrum::planck(double temperature_k, double scale, std::optional<Range> range) {
  if (!std::isfinite(temperature_k) || temperature_k < 0)
    throw InputError("planck: temperature " + format_number(temperature_k) +
                     " K: must be finite and at least 0");
  require_finite("planck: scale", scale);
  if (range &&
      !(std::isfinite(range->min_nm) && std::isfinite(range->max_nm) && range->min_nm < range->max_nm))
    throw InputError("planck: range " + format_number(range->min_nm) + " to " + format_number(range->max_nm) +
                     " nm: must increase");
  return Spectrum(std::make_shared<PlanckNode>(temperature_k, scale, range));
}

Spectrum Spectrum::product(const Spectrum& a, const Spectrum& b) {
  const auto* constant_a = dynamic_cast<const ConstantNode*>(a.node_.get());
  const auto* constant_b = dynamic_cast<const ConstantNode*>(b.node_.get());
  if (constant_a) return b.scaled(constant_a->value(0));
  if (constant_b) return a.scaled(constant_b->value(0));
  std::vector<std::shared_ptr<const Node>> factors;
  append_factors(a.node_, factors);
  append_factors(b.node_, factors);
  return Spectrum(std::make_shared<ProductNode>(std::move(factors)));
}

Spectrum Spectrum::scaled(double factor) const {
  require_finite("spectrum: scale", factor);
  Spectrum result(node_->scaled(factor));
  for (const double value : result.knot_values()) require_finite("spectrum: scaled value", value);
  if (result.knots_nm().empty() && result.is_constant())
    require_finite("spectrum: scaled value", result(555));
  return result;
}

Spectrum Spectrum::extrapolated() const {
  std::shared_ptr<const Node> node = node_->extrapolated();
  return node ? Spectrum(std::move(node)) : *this;
}

double Spectrum::operator()(double lambda_nm) const {
  return node_->value(lambda_nm);
}

void Spectrum::evaluate(std::span<const double> lambda_nm, std::span<double> out) const {
  if (lambda_nm.size() != out.size())
    throw std::logic_error("Spectrum::evaluate: spans of different lengths");
  node_->evaluate(lambda_nm, out);
}

double Spectrum::max_over(double min_nm, double max_nm) const {
  require_interval(min_nm, max_nm);
  return node_->bounds(min_nm, max_nm).max;
}

double Spectrum::min_over(double min_nm, double max_nm) const {
  require_interval(min_nm, max_nm);
  return node_->bounds(min_nm, max_nm).min;
}

double Spectrum::integral(double min_nm, double max_nm) const {
  require_interval(min_nm, max_nm);
  return min_nm == max_nm ? 0 : node_->integral(min_nm, max_nm);
}

bool Spectrum::is_constant() const {
  return node_->is_constant();
}
std::optional<Spectrum::PlanckParameters> Spectrum::planck_parameters() const {
  return node_->planck_parameters();
}
std::optional<Spectrum::Range> Spectrum::data_range() const {
  return node_->data_range();
}
bool Spectrum::extrapolates() const {
  return node_->extrapolates();
}
std::span<const double> Spectrum::knots_nm() const {
  return node_->knots_nm();
}
std::span<const double> Spectrum::knot_values() const {
  return node_->knot_values();
}

}  // namespace kiloband
