// Hits of spheres, disks and cylinders, and what of a hit needs double precision.
#pragma once

#include "src_cpu/geometry/shape_geometry.hpp"

namespace kiloband::cpu {

struct AnalyticHit {
  SurfacePoint surface;
  float offset;         // m: how far off the surface rays begin (ray_offset-inl.hpp)
  glm::vec3 departure;  // the point off the rim: what rays begin off
};

/// The surface at origin + distance * direction.
AnalyticHit analytic_hit(const KbShape& shape, glm::vec3 origin, glm::vec3 direction, float distance);

/// The unit normal of a triangle with these edges, whose area underflows in float.
glm::vec3 tiny_normal(glm::vec3 e1, glm::vec3 e2);

}  // namespace kiloband::cpu
