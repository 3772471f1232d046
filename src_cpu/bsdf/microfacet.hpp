// Beckmann and GGX distributions of microfacet normals with Smith's masking.
//
// All vectors are in the local shading frame. Directions v have v.z > 0: callers mirror what comes from
// below. Sources: Walter et al. 2007 (distributions, masking), Heitz and d'Eon 2014 (visible normals), Dupuy
// and Benyoub 2023 (visible GGX normals from a spherical cap).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "shared/estimator.h"
#include "shared/records.h"

namespace kiloband::cpu {

class FacetDistribution {
 public:
  explicit FacetDistribution(const KbMaterial& material)
      : FacetDistribution((material.flags & KB_MATERIAL_GGX) != 0, material.alpha_u, material.alpha_v,
                          (material.flags & KB_MATERIAL_SAMPLE_VISIBLE) != 0) {}
  FacetDistribution(bool ggx, float alpha_u, float alpha_v, bool visible)
      : alpha_u_(std::max(alpha_u, KB_MIN_ALPHA)),
        alpha_v_(std::max(alpha_v, KB_MIN_ALPHA)),
        ggx_(ggx),
        visible_(visible) {}

  bool sample_visible() const { return visible_; }
  float min_alpha() const { return std::min(alpha_u_, alpha_v_); }
  FacetDistribution scaled(float factor) const {
    return {ggx_, alpha_u_ * factor, alpha_v_ * factor, visible_};
  }

  /// Density of normals per solid angle and projected area:
  /// the integral of D(m) m.z over the hemisphere is 1.
  float normal_density(glm::vec3 m) const {
    if (!(m.z > 1e-6f)) return 0;
    const float x = m.x / alpha_u_, y = m.y / alpha_v_, z2 = m.z * m.z;
    const float scale = KB_PI * alpha_u_ * alpha_v_;
    if (ggx_) {
      const float t = x * x + y * y + z2;
      return 1 / (scale * t * t);
    }
    return std::exp(-(x * x + y * y) / z2) / (scale * z2 * z2);
  }

  /// Smith's masking G1(v) / v.z. Stays finite at grazing angles, where G1 vanishes with v.z.
  float masking_over_cos(glm::vec3 v) const {
    const float x = alpha_u_ * v.x, y = alpha_v_ * v.y;
    const float xy2 = x * x + y * y;
    if (ggx_) return 2 / (v.z + std::sqrt(v.z * v.z + xy2));
    // G1 = 2 / (1 + erf(a) + exp(-a^2) / (a sqrt(pi))), a = 1 / (alpha tan theta); 1 - G1 < 1e-9 for a > 4
    const float root = std::sqrt(xy2);
    if (v.z > 4 * root) return 1 / v.z;
    const float a = v.z / root;
    return 2 / (v.z * (1 + std::erf(a)) + root * kInvSqrtPi * std::exp(-a * a));
  }
  float masking(glm::vec3 v) const { return std::min(masking_over_cos(v) * v.z, 1.0f); }

  /// Density per solid angle of the normals that sample_normal(wi, .) returns; dot_im = dot(wi, m).
  float normal_pdf(glm::vec3 wi, glm::vec3 m, float density, float dot_im) const {
    return visible_ ? density * masking_over_cos(wi) * std::max(dot_im, 0.0f) : density * m.z;
  }
  /// A unit normal with m.z >= 0; u uniform in [0,1)^2.
  glm::vec3 sample_normal(glm::vec3 wi, glm::vec2 u) const;

  static constexpr float kInvSqrtPi = 0.56418958354775628695f;

 private:
  float alpha_u_, alpha_v_;
  bool ggx_, visible_;
};

}  // namespace kiloband::cpu
