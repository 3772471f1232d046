// From a ray hit to the point, its normals and texture coordinates, for one path: see surface_hit-inl.hpp.
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

}  // namespace kiloband::cpu
