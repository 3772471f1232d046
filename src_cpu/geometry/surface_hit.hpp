// From a ray hit to the point, its normals, texture coordinates and shading frame, for one path: see
// surface_hit-inl.hpp.
#pragma once

#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

struct SurfaceHit {
  glm::vec3 point{0};
  glm::vec3 geometric_normal{0};  // unit; meshes: of the triangle's winding
  glm::vec3 shading_normal{0};    // unit; meshes: of the vertex normals, where there are any
  glm::vec3 tangent{0};           // dp/du, not normalised; zero if unknown
  float offset = 0;               // m: how far off the surface rays begin (ray_offset-inl.hpp)
  glm::vec3 departure{0};         // the point off the edges: what rays begin off
  glm::vec2 uv{0};
  uint32_t shape = KB_NONE;
  uint32_t triangle = 0;     // meshes: in the shape
  glm::vec2 barycentric{0};  // meshes: weights of its second and third vertex
};

/// ray_origin + t * direction is only used for analytic shapes;
/// mesh points come from barycentric coordinates.
SurfaceHit make_surface_hit(const FlatScene& scene, uint32_t shape, uint32_t primitive, float u, float v,
                            glm::vec3 ray_origin, glm::vec3 direction, float t);

/// Which side of a surface is seen from `away` (a direction away from it): the rule for what area lights
/// emit, what thermal emission and BSDFs are, for hits and light samples alike. Vertex normals decide, not
/// the winding (Mitsuba 3). The media of a surface's sides follow geometric_normal instead: a ray that
/// crosses the surface must find the other medium behind it.
inline bool on_front(glm::vec3 shading_normal, glm::vec3 away) {
  return glm::dot(shading_normal, away) > 0;
}

/// Orthonormal frame with z = shading normal; x along the tangent where there is one (anisotropic roughness).
struct ShadingFrame {
  glm::vec3 x, y, z;

  ShadingFrame(glm::vec3 normal, glm::vec3 tangent);
  glm::vec3 to_local(glm::vec3 w) const { return {glm::dot(w, x), glm::dot(w, y), glm::dot(w, z)}; }
  glm::vec3 to_world(glm::vec3 w) const { return w.x * x + w.y * y + w.z * z; }
};

}  // namespace kiloband::cpu
