// Building the light tree (shared/light_tree.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <span>
#include <vector>

#include "shared/light_tree.h"

namespace kiloband {

/// Where lights lie and where they shine to.
struct LightBounds {
  glm::dvec3 low, high;            // m
  glm::dvec3 axis{0, 0, 1};        // unit
  double cone = std::numbers::pi;  // rad: half angle of the cone of normals; pi: all directions
  double power = 0;                // > 0

  glm::dvec3 centre() const { return 0.5 * (low + high); }
};

/// rad, from 0 to pi; exact for small ones, too
double angle_between(const glm::dvec3& a, const glm::dvec3& b);

/// What bounds both.
LightBounds merged(const LightBounds& a, const LightBounds& b);

struct LightTree {
  std::vector<KbLightNode> nodes;  // 2 lights - 1
  std::vector<uint32_t> leaves;    // by light: its node
};

/// Splits where surface area, cone and power of the halves are least (the surface area orientation heuristic), among twelve
/// places along each axis.
/// lights  finite, of positive power; at most 2^30
LightTree build_light_tree(std::span<const LightBounds> lights);

}  // namespace kiloband
