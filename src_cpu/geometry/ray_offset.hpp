// Where a ray leaves a surface, for one path: see ray_offset-inl.hpp. Spheres, disks and cylinders besides.
#pragma once

#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband::cpu {

float surface_offset(glm::vec3 largest_coordinates, glm::vec3 unit_normal);
float target_offset(float offset, glm::vec3 to_light);

/// Of a sphere, disk or cylinder: no point of it has a larger one.
glm::vec3 largest_coordinates(const KbShape& shape);

/// As off_the_edges() of ray_offset-inl.hpp, for disks and cylinders, which close bodies with others at their rims.
/// uv  of the point, as SurfacePoint has it: a disk's u is the radius, a cylinder's v the height
glm::vec3 off_the_rim(const KbShape& shape, glm::vec3 p, glm::vec2 uv, float offset);

inline glm::vec3 offset_ray_origin(glm::vec3 p, glm::vec3 unit_normal, float offset) {
  return p + offset * unit_normal;
}

}  // namespace kiloband::cpu
