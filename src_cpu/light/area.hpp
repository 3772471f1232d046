// Area lights: sampling and its density, without the probability of selecting the light.
#pragma once

#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// A point on an area light as seen from a shaded point.
struct AreaLightSample {
  float pdf = 0;     // solid angle [1/sr]; 0: no sample
  float factor = 1;  // pdf over the density that the sample really has: 1 but for triangles of meshes, which
                     // are chosen with a whole number of steps of 2^-24
  glm::vec3 direction{0};  // unit, towards the light
  glm::vec3 position{0};   // on the light
  glm::vec3 normal{0};     // unit, geometric, of the side that is seen
  float offset = 0;        // m, of rays that leave the light there (ray_offset-inl.hpp)
  glm::vec2 uv{0};         // filled in if asked for
  uint32_t triangle = 0;   // meshes: in the shape, and the point's barycentric coordinates
  glm::vec2 barycentric{0};
};

/// How the triangle of a mesh is chosen.
struct TriangleChoice {
  float u;        // by the mesh's table with this number ...
  uint32_t tree;  // ... unless the light tree has chosen this one: KB_NONE: it has not;
  float area;     // of it, m^2
};
AreaLightSample sample_area_light(const FlatScene& scene, const KbShape& shape, const TriangleChoice& choice,
                                  glm::vec3 point, glm::vec2 u, bool need_uv);

/// The same density for a given point of a sphere; 0 where sample_area_light() cannot give it.
float sphere_light_density(const KbShape& shape, glm::vec3 origin, glm::vec3 hit_point);

}  // namespace kiloband::cpu
