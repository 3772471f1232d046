#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace kiloband::reference {

long double fresnel(long double cos_i, long double eta) {
  using Complex = std::complex<long double>;
  const long double sin_i = std::sqrt((1 - cos_i) * (1 + cos_i));
  const Complex cos_t = std::sqrt(Complex(1 - sin_i * sin_i / (eta * eta), 0));
  const Complex s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const Complex p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return (std::norm(s) + std::norm(p)) / 2;
}

double diffuse_fresnel(double eta) {
  constexpr int n = 200000;
  long double sum = 0;
  for (int i = 0; i < n; ++i) {
    const long double mu = (i + 0.5L) / n;
    sum += fresnel(mu, eta) * mu;
  }
  return static_cast<double>(2 * sum / n);
}

double normal_density(const Roughness& r, Vec m) {
  if (m.z <= 0) return 0;
  const double tan2 =
      (m.x * m.x / (r.alpha_u * r.alpha_u) + m.y * m.y / (r.alpha_v * r.alpha_v)) / (m.z * m.z);
  const double slopes = r.ggx ? std::pow(1 + tan2, -2) : std::exp(-tan2);
  return slopes / (M_PI * r.alpha_u * r.alpha_v * std::pow(m.z, 4));
}

double masking(const Roughness& r, Vec v) {
  const double sin2 = v.x * v.x + v.y * v.y;
  if (sin2 == 0) return 1;
  const double projected = std::hypot(r.alpha_u * v.x, r.alpha_v * v.y) / std::abs(v.z);  // alpha tan theta
  if (r.ggx) return 2 / (1 + std::sqrt(1 + projected * projected));
  const double a = 1 / projected;
  return 1 / (1 + 0.5 * (std::erf(a) - 1) + std::exp(-a * a) / (2 * a * std::sqrt(M_PI)));
}

Vec mean_over_visible_normals(const Roughness& r, Vec wi, int n, const std::function<Vec(Vec)>& g) {
  Vec sum(0);
  for (int i = 0; i < n; ++i) {
    const double t = (i + 0.5) / n, u = t * t;
    const double radius = r.ggx ? std::sqrt((1 - u) / u) : std::sqrt(-std::log(u));
    for (int j = 0; j < n; ++j) {
      const double phi = 2 * M_PI * (j + 0.5) / n;
      const Vec slope_normal(-r.alpha_u * radius * std::cos(phi), -r.alpha_v * radius * std::sin(phi), 1);
      const double projected = glm::dot(wi, slope_normal);  // = wi.m / m.z
      if (projected > 0) sum += 2 * t * projected * g(glm::normalize(slope_normal));
    }
  }
  return masking(r, wi) / wi.z * sum / (double(n) * n);
}

Albedo rough_albedo(const Roughness& r, Vec wi, double eta, int n) {
  const Vec sums = mean_over_visible_normals(r, wi, n, [&](Vec m) -> Vec {
    const double d = std::min(glm::dot(wi, m), 1.0);
    const double f = eta > 0 ? static_cast<double>(fresnel(d, eta)) : 1;
    const Vec up = 2 * d * m - wi;
    Vec parts(0);
    (up.z > 0 ? parts.x : parts.z) += up.z > 0 ? f * masking(r, up) : f;
    if (f == 1) return parts;
    const Vec down = (d / eta - std::sqrt(1 - (1 - d * d) / (eta * eta))) * m - wi / eta;
    (down.z < 0 ? parts.y : parts.z) += down.z < 0 ? (1 - f) * masking(r, down) : 1 - f;
    return parts;
  });
  return {sums.x, sums.y, sums.z};
}

}  // namespace kiloband::reference
