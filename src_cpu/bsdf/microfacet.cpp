#include "src_cpu/bsdf/microfacet.hpp"

#include "shared/filter_sample.h"

namespace kiloband::cpu {
namespace {

constexpr float kLargestBelowOne = KB_ONE_MINUS_EPSILON;

/// Slope towards the viewer of a visible Beckmann normal for alpha = 1 and a view at angle theta,
/// cot = cos / sin. Slopes s < cot are visible with density ~ (cos - s sin) exp(-s^2). In b = erf(s) the
/// distribution function times its norm is
///   c(b) = cos (1 + b) + sin exp(-s^2) / sqrt(pi),  c'(b) = cos - s sin >= 0;
/// c(b) = u norm is solved by Newton's method, kept inside a bracket that shrinks by
/// at least half whenever a step leaves it.
float visible_beckmann_slope(float cos_theta, float sin_theta, float u) {
  const float cot = cos_theta / sin_theta;  // infinite at normal incidence, which is fine
  const float k = sin_theta * FacetDistribution::kInvSqrtPi;
  const float last = std::erf(cot);
  const float target = u * (cos_theta * (1 + last) + k * std::exp(-cot * cot));
  float low = -1, high = last;
  // Between the solutions for theta = pi/2 (s = -sqrt(-log u)) and theta = 0 (b = 2 u - 1).
  const float grazing = -std::erf(std::sqrt(-std::log(std::max(u, 1e-30f))));
  float b = std::clamp(grazing + (2 * u - 1 - grazing) * cos_theta, low, high);
  for (int i = 0; i < 12; ++i) {
    const float s = kb_erf_inv(b);
    const float excess = cos_theta * (1 + b) + k * std::exp(-s * s) - target;
    (excess > 0 ? high : low) = b;
    if (std::abs(excess) < 5e-7f) break;  // the norm is between 0.56 and 2
    const float slope = cos_theta - s * sin_theta;
    const float next = b - excess / slope;
    b = next > low && next < high ? next : 0.5f * (low + high);  // also taken when slope == 0
  }
  return std::min(kb_erf_inv(b), cot);
}

glm::vec3 sample_visible_beckmann(glm::vec3 wi, glm::vec2 alpha, glm::vec2 u) {
  const glm::vec3 v = glm::normalize(glm::vec3(alpha.x * wi.x, alpha.y * wi.y, wi.z));
  const float sin_theta = std::sqrt(v.x * v.x + v.y * v.y);
  const glm::vec2 axis = sin_theta > 0 ? glm::vec2(v.x, v.y) / sin_theta : glm::vec2(1, 0);
  const float along = visible_beckmann_slope(v.z, sin_theta, u.x);
  const float across = kb_erf_inv(2 * u.y - 1);
  const glm::vec2 slope(axis.x * along - axis.y * across, axis.y * along + axis.x * across);
  return glm::normalize(glm::vec3(-slope.x * alpha.x, -slope.y * alpha.y, 1));
}

/// The cap of the unit sphere around the stretched view direction, shifted by it, gives visible GGX normals.
/// Its lower part is cut at z = -v.z; h.z = (1 - u)(1 + v.z) is formed directly, so that nothing cancels.
glm::vec3 sample_visible_ggx(glm::vec3 wi, glm::vec2 alpha, glm::vec2 u) {
  const glm::vec3 v = glm::normalize(glm::vec3(alpha.x * wi.x, alpha.y * wi.y, wi.z));
  const float phi = 2 * KB_PI * u.y;
  const float height = (1 - u.x) * (1 + v.z);
  const float z = height - v.z;
  const float r = std::sqrt(std::max(0.0f, (1 - z) * (1 + z)));
  const glm::vec3 h(r * std::cos(phi) + v.x, r * std::sin(phi) + v.y, height);
  return glm::normalize(glm::vec3(h.x * alpha.x, h.y * alpha.y, h.z));
}

}  // namespace

glm::vec3 FacetDistribution::sample_normal(glm::vec3 wi, glm::vec2 u) const {
  const glm::vec2 alpha(alpha_u_, alpha_v_);
  if (visible_) return ggx_ ? sample_visible_ggx(wi, alpha, u) : sample_visible_beckmann(wi, alpha, u);
  // Slopes (alpha_u r cos phi, alpha_v r sin phi); r^2 has distribution 1 - exp(-r^2),
  // or r^2 / (1 + r^2) for GGX.
  const float rest = std::max(1 - u.x, 1 - kLargestBelowOne);
  const float r = std::sqrt(ggx_ ? u.x / rest : -std::log(rest));
  const float phi = 2 * KB_PI * u.y;
  return glm::normalize(glm::vec3(alpha.x * r * std::cos(phi), alpha.y * r * std::sin(phi), 1));
}

}  // namespace kiloband::cpu
