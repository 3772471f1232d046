// Small helpers that the parts of the path tracer share.
#pragma once

#include <glm/glm.hpp>
#include <limits>

#include "src_cpu/embree_scene.hpp"

namespace kiloband {

inline constexpr float kInfiniteDistance = std::numeric_limits<float>::infinity();

inline void push_ray(RayQueue& queue, glm::vec3 origin, glm::vec3 direction, float t_min, float t_max) {
  queue.push({origin.x, origin.y, origin.z}, {direction.x, direction.y, direction.z}, t_min, t_max);
}

inline glm::vec3 ray_origin(const RayQueue& rays, std::size_t i) { return {rays.ox[i], rays.oy[i], rays.oz[i]}; }
inline glm::vec3 ray_direction(const RayQueue& rays, std::size_t i) { return {rays.dx[i], rays.dy[i], rays.dz[i]}; }

/// Veach's power heuristic with beta = 2: the weight of the technique with density pdf against one with density other.
/// Safe for densities whose squares would overflow.
inline float power_heuristic(float pdf, float other) {
  if (!(pdf < kInfiniteDistance)) return 1;
  const float ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

}  // namespace kiloband
