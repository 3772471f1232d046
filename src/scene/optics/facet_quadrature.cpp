#include "scene/optics/facet_quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/gauss_legendre.hpp"
#include "shared/estimator.h"

namespace kiloband {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSlopes = 5.5;  // Beckmann: exp(-5.5^2) = 7e-14

const GaussLegendre& rule_of(int n) {
  thread_local std::map<int, GaussLegendre> rules;
  const auto [place, is_new] = rules.try_emplace(n);
  if (is_new) place->second = gauss_legendre(n);
  return place->second;
}

// For alpha = 1 and a view v whose projected roughness is root, slopes a towards the view and b across it are
// visible with weight P(a, b) (v.z + root a) G1 / v.z where p(a) = v.z + root a > 0.
//   Beckmann  P = exp(-a^2 - b^2) / pi
//   GGX       P = 1 / (pi (1 + a^2 + b^2)^2). With b = tan w, a = tan t / cos w the weight is
//             (v.z cos w cos^2 t + root sin t cos t) / pi dw dt, which stays smooth.
// In the surface's frame the normal is (slopes, 1) / sqrt N with N = 1 + slope_x^2 + slope_y^2, a parabola in
// a. Where the integrand has edges, p and N obey quadratic equations:
//   reflection leaves the surface         2 p = v.z N
//   total reflection ends                 p^2 = (1 - eta^2) N
//   transmission leaves the surface       v.z^2 N - 2 v.z p = eta^2 - 1
// Integrals over a are cut there, those over b where two such edges meet: where a discriminant,
// a parabola in b, is 0.

/// c0 + c1 a + c2 a^2.
struct Parabola {
  double c0, c1, c2;
};

void append_roots(const Parabola& f, std::vector<double>& roots) {
  const double discriminant = f.c1 * f.c1 - 4 * f.c2 * f.c0;
  if (!(discriminant >= 0)) return;
  const double q = -0.5 * (f.c1 + std::copysign(std::sqrt(discriminant), f.c1));
  if (f.c2 != 0) roots.push_back(q / f.c2);
  if (q != 0) roots.push_back(f.c0 / q);
}

/// An edge as a conic: k0 + k2 b^2 + (l0 + l1 b) a + m a^2 = 0.
struct Edge {
  double k0, k2, l0, l1, m;

  Parabola along(double b) const { return {k0 + k2 * b * b, l0 + l1 * b, m}; }
  Parabola discriminant() const { return {l0 * l0 - 4 * m * k0, 2 * l0 * l1, l1 * l1 - 4 * m * k2}; }
};

/// The view's geometry, and the visible facets that are collected.
class FacetRule {
 public:
  FacetRule(const Facets& facets, const glm::dvec3& v, double eta, int nodes)
      : facets_(facets), v_(v), eta_(eta), across_(rule_of(nodes)), along_(rule_of(nodes)) {
    const double x = facets.alpha_u * v.x, y = facets.alpha_v * v.y;
    root_ = std::hypot(x, y);
    if (root_ > 0) cos_phi_ = x / root_, sin_phi_ = y / root_;
    masking_over_cos_ = facets.masking_over_cos(v);
  }

  std::vector<VisibleFacet> run() {
    const double end = facets_.ggx ? 0.5 * kPi : kSlopes;
    visible_.reserve(1 << 15);
    make_edges();
    std::vector<double> cuts{end};
    for (const Edge& edge : edges_) {
      std::vector<double> roots;
      append_roots(edge.discriminant(), roots);
      for (const double b : roots) {
        const double w = facets_.ggx ? std::atan(b) : b;
        if (std::abs(w) < end) cuts.push_back(w);
      }
    }
    std::sort(cuts.begin(), cuts.end());
    double from = -end;
    for (const double to : cuts) {
      if (to > from) add_strip(from, to);
      from = to;
    }
    return std::move(visible_);
  }

 private:
  void make_edges() {
    const double au2 = facets_.alpha_u * facets_.alpha_u, av2 = facets_.alpha_v * facets_.alpha_v;
    const double c = cos_phi_, s = sin_phi_, z = v_.z;
    // N = 1 + nb b^2 + nab a b + na a^2
    const double nb = au2 * s * s + av2 * c * c, nab = 2 * (av2 - au2) * c * s,
                 na = au2 * c * c + av2 * s * s;
    edges_.push_back({z, -z * nb, 2 * root_, -z * nab, -z * na});
    if (eta_ == 1) return;
    const double total = 1 - eta_ * eta_;
    if (total > 0)
      edges_.push_back({z * z - total, -total * nb, 2 * z * root_, -total * nab, root_ * root_ - total * na});
    edges_.push_back({total - z * z, z * z * nb, -2 * z * root_, z * z * nab, z * z * na});
  }

  /// w or b from one value to another.
  void add_strip(double from, double to) {
    for (std::size_t i = 0; i < across_.nodes.size(); ++i) {
      const double w = 0.5 * ((to - from) * across_.nodes[i] + to + from),
                   step = 0.5 * (to - from) * across_.weights[i] / kPi;
      if (facets_.ggx) {
        add_line(std::tan(w), std::cos(w), step);
      } else {
        add_line(w, 1, step * std::exp(-w * w));
      }
    }
  }

  /// All slopes a for one b. cosine: of w (GGX)
  void add_line(double b, double cosine, double weight) {
    const double end = facets_.ggx ? 0.5 * kPi : kSlopes;
    std::vector<double> edges, roots;
    for (const Edge& edge : edges_) append_roots(edge.along(b), roots);
    for (const double a : roots) {
      const double t = facets_.ggx ? std::atan(a * cosine) : a;
      if (std::abs(t) < end) edges.push_back(t);
    }
    edges.push_back(end);
    const double lowest = root_ > 0 ? -v_.z / root_ : -1e300;
    double from = std::max(facets_.ggx ? std::atan(lowest * cosine) : lowest, -end);
    std::sort(edges.begin(), edges.end());
    for (const double to : edges) {
      if (!(to > from)) continue;
      add_piece(from, to, b, cosine, weight * 0.5 * (to - from));
      from = to;
    }
  }

  void add_piece(double from, double to, double b, double cosine, double weight) {
    const glm::dvec2 across(-facets_.alpha_u * sin_phi_ * b, facets_.alpha_v * cos_phi_ * b);
    const glm::dvec2 along(facets_.alpha_u * cos_phi_, facets_.alpha_v * sin_phi_);
    for (std::size_t i = 0; i < along_.nodes.size(); ++i) {
      const double t = 0.5 * ((to - from) * along_.nodes[i] + to + from);
      double density, a = t;
      if (facets_.ggx) {
        const double c = std::cos(t), s = std::sin(t);
        density = (v_.z * cosine * c + root_ * s) * c;
        a = s / (c * cosine);
      } else {
        density = (v_.z + root_ * t) * std::exp(-t * t);
      }
      const glm::dvec2 slope = a * along + across;
      const double inverse = 1 / std::sqrt(1 + slope.x * slope.x + slope.y * slope.y);
      visible_.push_back(
          {glm::dvec3(slope, 1) * inverse, masking_over_cos_ * weight * along_.weights[i] * density});
    }
  }

  const Facets& facets_;
  glm::dvec3 v_;
  double eta_;
  const GaussLegendre &across_, &along_;
  double root_ = 0, cos_phi_ = 1, sin_phi_ = 0, masking_over_cos_ = 1;
  std::vector<Edge> edges_;
  std::vector<VisibleFacet> visible_;
};

}  // namespace

Facets::Facets(const KbMaterial& material)
    : ggx((material.flags & KB_MATERIAL_GGX) != 0),
      alpha_u(std::max<double>(material.alpha_u, KB_MIN_ALPHA)),
      alpha_v(std::max<double>(material.alpha_v, KB_MIN_ALPHA)) {}

double Facets::masking_over_cos(const glm::dvec3& v) const {
  const double root = std::sqrt(alpha_u * alpha_u * v.x * v.x + alpha_v * alpha_v * v.y * v.y);
  if (ggx) return 2 / (v.z + std::sqrt(v.z * v.z + root * root));
  if (!(root > 0)) return 1 / v.z;
  const double a = v.z / root;
  return 2 / (v.z * (1 + std::erf(a)) + root * std::exp(-a * a) / std::sqrt(kPi));
}

double Facets::masking(const glm::dvec3& v) const {
  return v.z > 0 ? std::min(masking_over_cos(v) * v.z, 1.0) : 0;
}

std::vector<VisibleFacet> visible_facets(const Facets& facets, const glm::dvec3& v, double eta, int nodes) {
  return FacetRule(facets, v, eta, nodes).run();
}

double dielectric_reflectance(double cos_i, double eta) {
  const double sin2_t = (1 - cos_i) * (1 + cos_i) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const double cos_t = std::sqrt(1 - sin2_t);
  const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return 0.5 * (s * s + p * p);
}

/// With s^2 = 1 - c^2, t = n^2 - 1 - k^2 + c^2, q = |(n - ik)^2 - s^2| = sqrt(t^2 + 4 n^2 k^2), and a the real part of
/// the root of (n - ik)^2 - s^2, a^2 = (q + t) / 2:
///   R_s = (q + c^2 - 2 a c) / (q + c^2 + 2 a c)
///   R_p = R_s Q,  Q = (q c^2 + s^4 - 2 a c s^2) / (q c^2 + s^4 + 2 a c s^2).
/// q + t cancels where k >> n (silver would lose four digits); there a = n k / b with the imaginary part
/// b^2 = (q - t) / 2. 1 - R_s and 1 - Q are taken as fractions of their own.
/// Source: Born, Wolf, Principles of Optics, 7th ed., 14.2.
double metal_absorptance(double cos_i, double n, double k) {
  const double c2 = cos_i * cos_i, s2 = (1 - cos_i) * (1 + cos_i);
  const double t = (n - 1) * (n + 1) - k * k + c2;
  const double q = std::hypot(t, 2 * n * k);
  const double root = std::sqrt(0.5 * (q + std::abs(t)));
  const double a = t >= 0 ? root : (root > 0 ? n * k / root : 0);
  const double ac2 = 2 * a * cos_i;
  const double sum_s = q + c2 + ac2, sum_p = q * c2 + s2 * s2 + ac2 * s2;
  const double absorbed_s = sum_s > 0 ? std::min(2 * ac2 / sum_s, 1.0) : 0;
  const double lost_q = sum_p > 0 ? std::min(2 * ac2 * s2 / sum_p, 1.0) : 0;
  return absorbed_s + 0.5 * (1 - absorbed_s) * lost_q;
}

double mirror_albedo(const Facets& facets, const glm::dvec3& v, int nodes) {
  double sum = 0;
  for (const VisibleFacet& f : visible_facets(facets, v, 1, nodes))
    sum += f.weight * facets.masking(2 * glm::dot(v, f.normal) * f.normal - v);
  return sum;
}

Albedo boundary_albedo(const Facets& facets, const glm::dvec3& v, double eta, int nodes) {
  Albedo sum;
  for (const VisibleFacet& f : visible_facets(facets, v, eta, nodes)) {
    const double c = std::clamp(glm::dot(v, f.normal), 0.0, 1.0);
    const double r = dielectric_reflectance(c, eta);
    sum.reflected += f.weight * r * facets.masking(2 * c * f.normal - v);
    if (r >= 1) continue;
    const double cos_t = std::sqrt(std::max(0.0, 1 - (1 - c) * (1 + c) / (eta * eta)));
    const glm::dvec3 t = (c / eta - cos_t) * f.normal - v / eta;
    sum.transmitted += f.weight * (1 - r) * facets.masking(glm::dvec3(t.x, t.y, -t.z));
  }
  return sum;
}

glm::dvec3 compensation_direction(const Facets& facets, double x, double s, bool dielectric) {
  const double exponent = dielectric ? 0.25 : 1;
  const glm::dvec2 azimuth = glm::normalize(glm::dvec2(std::sqrt(1 - s) / std::pow(facets.alpha_u, exponent),
                                                       std::sqrt(s) / std::pow(facets.alpha_v, exponent)));
  const double alpha = std::hypot(facets.alpha_u * azimuth.x, facets.alpha_v * azimuth.y);
  const double sine = (1 - x) / std::hypot(1 - x, alpha * x),
               cosine = alpha * x / std::hypot(1 - x, alpha * x);
  return {sine * azimuth.x, sine * azimuth.y, cosine};
}

}  // namespace kiloband
