// Maps from the unit square to disk and sphere: those of shared/warp.h, for glm vectors.
#pragma once

#include <glm/glm.hpp>

#include "shared/warp.h"

namespace kiloband::cpu {

/// Uniform point of the unit disk; keeps neighbours together (Shirley and Chiu 1997).
inline glm::vec2 warp_concentric_disk(glm::vec2 u) {
  const KbFloat2 p = kb_disk_concentric(u.x, u.y);
  return {p.x, p.y};
}

/// Uniform point of the unit sphere.
inline glm::vec3 warp_uniform_sphere(glm::vec2 u) {
  const KbFloat3 w = kb_sphere_uniform(u.x, u.y);
  return {w.x, w.y, w.z};
}

}  // namespace kiloband::cpu
