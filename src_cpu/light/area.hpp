// Area lights: sampling and its density, without the probability of selecting the light.
#pragma once

#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/geometry/surface_hit.hpp"

namespace kiloband::cpu {

/// Largest i in [0, count) with cdf[i] <= u; intervals of zero width are never chosen. cdf has count + 1
/// entries, 0 to 1.
inline uint32_t find_interval(const float* cdf, uint32_t count, float u) {
  // The last entry that is not above u begins the interval. Without branches: their outcome would be random.
  uint32_t first = 0;
  for (uint32_t length = count; length > 1;) {
    const uint32_t half = length / 2;
    first += cdf[first + half] <= u ? half : 0;
    length -= half;
  }
  return first;
}

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

/// The same density for a given hit of the shape; 0 where sample_area_light() cannot give it.
/// area  of what points are chosen on: the shape, or the triangle that the light tree chooses, m^2
/// The other arguments as area_light_pdf().
float area_light_density(const KbShape& shape, const SurfaceHit& hit, glm::vec3 origin, float area);

/// Of spheres: for a point of the surface.
float sphere_light_density(const KbShape& shape, glm::vec3 origin, glm::vec3 hit_point);

}  // namespace kiloband::cpu
