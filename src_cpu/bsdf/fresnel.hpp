// Fresnel's formulas and Snell's law for a boundary between two dielectrics.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace kiloband::cpu {

struct DielectricFresnel {
  float reflectance = 1;  // unpolarised
  float cos_t = 0;        // cosine of the refracted direction, >= 0; 0 on total internal reflection
};

/// cos_i  in [0, 1], on the incident side
/// eta    transmitted over incident index, > 0
/// The cosine is formed as (eta^2 - 1 + cos_i^2) / eta^2 with eta^2 - 1 = (eta - 1)(eta + 1): nothing
/// cancels for eta >= 1.
inline DielectricFresnel fresnel_dielectric(float cos_i, float eta) {
  if (eta == 1) return {0, cos_i};
  const float square = (eta - 1) * (eta + 1) + cos_i * cos_i;
  if (!(square > 0)) return {1, 0};
  const float cos_t = std::min(std::sqrt(square) / eta, 1.0f);
  const float s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const float p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return {std::min(0.5f * (s * s + p * p), 1.0f), cos_t};
}

/// wi mirrored at the microfacet normal m
inline glm::vec3 reflect_at(glm::vec3 wi, glm::vec3 m) {
  return 2 * glm::dot(wi, m) * m - wi;
}

/// wi refracted at m; cos_t from fresnel_dielectric(dot(wi, m) > 0, eta), eta transmitted over incident
inline glm::vec3 refract_at(glm::vec3 wi, glm::vec3 m, float cos_t, float eta) {
  return (glm::dot(wi, m) / eta - cos_t) * m - wi / eta;
}

}  // namespace kiloband::cpu
