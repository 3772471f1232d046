#include "src_cpu/geometry/ray_offset.hpp"

#include <algorithm>
#include <cmath>

#include "src_cpu/geometry/shape_geometry_affine.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/geometry/ray_offset-inl.hpp"

namespace kiloband::cpu {

float surface_offset(glm::vec3 largest, glm::vec3 unit_normal) {
  return one_lane::surface_offset(to_lane(largest), to_lane(unit_normal)).v;
}

float target_offset(float offset, glm::vec3 to_light) {
  return one_lane::target_offset(offset, to_lane(to_light)).v;
}

glm::vec3 largest_coordinates(const KbShape& shape) {
  glm::vec3 largest;
  for (int axis = 0; axis < 3; ++axis) {
    const float* row = &shape.to_world[4 * axis];
    largest[axis] = std::fabs(row[3]) + std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]);
  }
  return largest;
}

glm::vec3 off_the_rim(const KbShape& shape, glm::vec3 p, glm::vec2 uv, float offset) {
  const auto column = [&](int c) { return affine_column<float>(shape.to_world, c); };
  if (shape.type == KB_SHAPE_SPHERE) return p;
  const bool disk = shape.type == KB_SHAPE_DISK;
  const glm::vec3 along = column(disk ? 0 : 2);
  const float least = std::min(8.0f * offset / std::sqrt(glm::dot(along, along)), 0.125f);
  if (disk) return p + (column(3) - p) * std::max(uv.x - (1 - least), 0.0f);
  return p + along * (std::max(least - uv.y, 0.0f) - std::max(uv.y - (1 - least), 0.0f));
}

}  // namespace kiloband::cpu
