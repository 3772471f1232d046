// Rays that pass null surfaces.
#pragma once

#include <algorithm>

#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/surface_hit.hpp"

namespace kiloband::cpu {

/// Whether rays pass any shape.
inline bool has_boundaries(const FlatScene& scene) {
  return std::ranges::any_of(scene.shapes, [](const KbShape& s) { return (s.flags & KB_SHAPE_NULL) != 0; });
}

inline bool is_boundary(const FlatScene& scene, uint32_t shape) {
  return shape != KB_NONE && (scene.shapes[shape].flags & KB_SHAPE_NULL);
}

/// The point from which a ray towards `direction` leaves the surface: off it,
/// on the side that the ray goes to.
inline glm::vec3 leave_surface(const SurfaceHit& hit, glm::vec3 direction) {
  const glm::vec3 n = hit.geometric_normal;
  return offset_ray_origin(hit.departure, glm::dot(n, direction) >= 0 ? n : -n, hit.offset);
}

/// The parameter of the point of a surface that a ray left, whose origin is off the surface:
/// columns of gas are measured from there.
inline float begin_at(glm::vec3 point, glm::vec3 origin, glm::vec3 direction) {
  return glm::dot(point - origin, direction) / glm::dot(direction, direction);
}

inline SurfaceHit surface_of(const FlatScene& scene, const TraceRay& ray) {
  return make_surface_hit(scene, ray.shape, ray.primitive, ray.u, ray.v, ray.origin(), ray.direction(),
                          ray.t_max);
}

}  // namespace kiloband::cpu
