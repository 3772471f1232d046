// Maps from the unit square to disk, sphere and triangle, as the CPU backend uses them.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "shared/lang.h"

namespace kiloband {

/// Uniform point of the unit disk; keeps neighbours together (Shirley and Chiu 1997).
inline glm::vec2 warp_concentric_disk(glm::vec2 u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::fabs(a) > std::fabs(b);
  const float radius = wide ? a : b;
  const float phi = wide ? (KB_PI / 4) * (b / a) : (KB_PI / 2) - (KB_PI / 4) * (a / b);
  return {radius * std::cos(phi), radius * std::sin(phi)};
}

/// Uniform point of the unit sphere. 1 - z = 2 u.x is exact near the pole.
inline glm::vec3 warp_uniform_sphere(glm::vec2 u) {
  const float radius = 2 * std::sqrt(u.x * (1 - u.x));
  const float phi = 2 * KB_PI * u.y;
  return {radius * std::cos(phi), radius * std::sin(phi), 1 - 2 * u.x};
}

/// Uniform barycentric coordinates (b1, b2) of a triangle, without a square root.
/// source  Heitz: A Low-Distortion Map Between Triangle and Square (2019)
inline glm::vec2 warp_uniform_triangle(glm::vec2 u) {
  if (u.y > u.x) return {0.5f * u.x, u.y - 0.5f * u.x};
  return {u.x - 0.5f * u.y, 0.5f * u.y};
}

}  // namespace kiloband
