// In double precision; a normal's two random numbers act separately (one sets the slope along the plane of
// incidence or the height, the other the rest), so that distribution functions are inverted once per node.
#include "src_gpu/scene/rough_transmittance.hpp"

#include <algorithm>
#include <cmath>

#include "src_gpu/scene/material_tables.hpp"

namespace kiloband::gpu {
namespace {

struct Vector {
  double x, y, z;
};

struct Rule {
  std::vector<double> nodes, weights;  // on [0, 1]
};

/// Legendre's polynomial of degree n and its derivative, by the three-term recurrence; |x| < 1.
std::pair<double, double> legendre(int n, double x) {
  double before = 1, value = x;
  for (int k = 2; k <= n; ++k) {
    const double next = x * value + (k - 1) * (x * value - before) / k;
    before = value;
    value = next;
  }
  return {value, n * (before - x * value) / (1 - x * x)};
}

/// Gauss-Legendre rule; its nodes are the polynomial's roots, separated by (i + 1/2) pi / (n + 1/2) in angle.
Rule gauss_rule(int n) {
  Rule rule;
  for (int i = 1; i <= n; ++i) {
    double x = std::cos(M_PI * (i - 0.25) / (n + 0.5));
    for (int step = 0; step < 8; ++step) {
      const auto [value, slope] = legendre(n, x);
      x -= value / slope;
    }
    const double slope = legendre(n, x).second;
    rule.nodes.push_back(0.5 + 0.5 * x);
    rule.weights.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

/// Where the increasing function reaches 0 between low and high.
template <class Function>
double root_between(double low, double high, Function function) {
  for (int step = 0; step < 48; ++step) {
    const double middle = 0.5 * (low + high);
    (function(middle) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// Fresnel's reflectance and the cosine of the refracted direction; eta: far over near index.
struct Boundary {
  double reflectance = 1, cos_t = 0;
};

Boundary boundary(double cos_i, double eta) {
  if (eta == 1) return {0, cos_i};
  const double sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return {};
  const double cos_t = std::sqrt(1 - sin2_t);
  const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return {0.5 * (s * s + p * p), cos_t};
}

/// Isotropic facets seen from w = (sin, 0, cos).
class VisibleFacets {
 public:
  VisibleFacets(bool ggx, double alpha, double cos_i) : ggx_(ggx), alpha_(alpha) {
    w_ = {std::sqrt(1 - cos_i * cos_i), 0, cos_i};
    const double size = std::hypot(alpha * w_.x, w_.z);
    stretched_ = {alpha * w_.x / size, 0, w_.z / size};
  }

  Vector direction() const { return w_; }

  /// What the first number alone determines: GGX the height of the shifted cap, Beckmann the slope in the
  /// plane of incidence.
  double first(double u) const { return ggx_ ? (1 - u) * (1 + stretched_.z) : beckmann_slope(u); }
  /// Of the second: GGX the azimuth, Beckmann the Gaussian slope across.
  double second(double u) const {
    if (ggx_) return 2 * M_PI * u;
    return root_between(-6, 6, [&](double s) { return std::erf(s) - (2 * u - 1); });
  }
  Vector normal(double first, double second) const {
    if (!ggx_) return unit({-alpha_ * first, -alpha_ * second, 1});
    const double z = first - stretched_.z;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return unit({alpha_ * (r * std::cos(second) + stretched_.x), alpha_ * r * std::sin(second), first});
  }
  /// Smith's G1.
  double masking(Vector v) const {
    const double tangent = alpha_ * std::hypot(v.x, v.y) / v.z;  // = 1 / a
    if (ggx_) return 2 / (1 + std::sqrt(1 + tangent * tangent));
    if (tangent < 0.1) return 1;  // short of 1 by less than 1e-40
    const double a = 1 / tangent;
    return 2 / (1 + std::erf(a) + std::exp(-a * a) * tangent / std::sqrt(M_PI));
  }

 private:
  static Vector unit(Vector v) {
    const double size = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return {v.x / size, v.y / size, v.z / size};
  }
  /// The slopes s < cot that are visible have density ~ (cos - s sin) exp(-s^2); its integral up to s is, but
  /// for a factor, cos (1 + erf s) + sin exp(-s^2) / sqrt(pi).
  double beckmann_slope(double u) const {
    const double cosine = stretched_.z, sine = stretched_.x;
    const auto integral = [&](double s) {
      return cosine * (1 + std::erf(s)) + sine * std::exp(-s * s) / std::sqrt(M_PI);
    };
    const double last = sine * 6 > cosine ? cosine / sine : 6;
    const double target = u * integral(last);
    return root_between(-6, last, [&](double s) { return integral(s) - target; });
  }

  bool ggx_;
  double alpha_;
  Vector w_, stretched_;
};

/// Mean over visible normals of F (or 1 - F) times the masking of where the light goes, for light from
/// `facets.direction()` at a boundary to `eta`.
double scattered_fraction(const VisibleFacets& facets, double eta, bool transmit, const Rule& rule) {
  const Vector w = facets.direction();
  double sum = 0;
  std::vector<double> second;
  for (const double u : rule.nodes) second.push_back(facets.second(u));
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    const double first = facets.first(rule.nodes[i]);
    for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
      const Vector m = facets.normal(first, second[j]);
      const double dot = std::clamp(w.x * m.x + w.z * m.z, 0.0, 1.0);
      const Boundary b = boundary(dot, eta);
      // by_m m - by_w w; what is transmitted is mirrored to the upper side.
      const double by_m = transmit ? dot / eta - b.cos_t : 2 * dot, by_w = transmit ? 1 / eta : 1;
      const double side = transmit ? -1 : 1;
      const Vector out{by_m * m.x - by_w * w.x, by_m * m.y, side * (by_m * m.z - by_w * w.z)};
      if (!(out.z > 0)) continue;
      const double share = transmit ? 1 - b.reflectance : b.reflectance;
      sum += rule.weights[i] * rule.weights[j] * share * facets.masking(out);
    }
  }
  return sum;
}

}  // namespace

RoughTransmittance make_rough_transmittance(const KbMaterial& material) {
  const bool ggx = material.distribution == KB_MICROFACET_GGX;
  const double alpha = std::max(material.alpha_u, 1e-4f), eta = material.eta;
  // From inside the integrand has the edge of total internal reflection: more nodes.
  static const Rule outside = gauss_rule(32), inside = gauss_rule(64);
  RoughTransmittance table;
  double internal = 0;
  for (int i = 0; i < kRoughPlasticNodes; ++i) {
    const double mu = std::max(1e-6, i / (kRoughPlasticNodes - 1.0));
    const VisibleFacets facets(ggx, alpha, mu);
    table.external.push_back(
        static_cast<float>(std::clamp(scattered_fraction(facets, eta, true, outside), 0.0, 1.0)));
    internal += mu * scattered_fraction(facets, 1 / eta, false, inside);
  }
  table.internal_reflectance = static_cast<float>(2 * internal / kRoughPlasticNodes);
  return table;
}

}  // namespace kiloband::gpu
