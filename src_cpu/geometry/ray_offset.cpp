#include "src_cpu/geometry/ray_offset.hpp"

#include <algorithm>
#include <cmath>

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

glm::vec3 largest_coordinates(glm::vec3 p0, glm::vec3 p1, glm::vec3 p2) {
  return glm::max(glm::max(glm::abs(p0), glm::abs(p1)), glm::abs(p2));
}

glm::vec3 off_the_edges(glm::vec3 p, glm::vec3 weights, const glm::vec3 (&corners)[3], glm::vec3 area_normal,
                        float offset) {
  const one_lane::Triangle triangle{to_lane(corners[0]),
                                    to_lane(corners[1]),
                                    to_lane(corners[2]),
                                    to_lane(corners[1] - corners[0]),
                                    to_lane(corners[2] - corners[0]),
                                    to_lane(area_normal)};
  return to_glm(one_lane::off_the_edges(triangle, to_lane(p), to_lane(weights), offset, {true}));
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
  const auto column = [&](int c) {
    return glm::vec3(shape.to_world[c], shape.to_world[4 + c], shape.to_world[8 + c]);
  };
  if (shape.type == KB_SHAPE_SPHERE) return p;
  const bool disk = shape.type == KB_SHAPE_DISK;
  const glm::vec3 along = column(disk ? 0 : 2);
  const float least = std::min(8.0f * offset / std::sqrt(glm::dot(along, along)), 0.125f);
  if (disk) return p + (column(3) - p) * std::max(uv.x - (1 - least), 0.0f);
  return p + along * (std::max(least - uv.y, 0.0f) - std::max(uv.y - (1 - least), 0.0f));
}

}  // namespace kiloband::cpu
