// Where a ray leaves a surface: off it by an amount that follows floating point precision, not the scene's
// size.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband {

/// How far off a surface rays begin, in m: far enough that a ray from there does not find the surface it left.
///
/// With u = 2^-24, a point on a triangle and the plane through it that an intersection test sees are wrong by a
/// few u times the corners' coordinates, each in its axis' share of the normal: a level plane is exact, however
/// wide, where its height is. Tests that turn the triangle into the ray's frame mix the axes: another u or two of
/// the largest coordinate. The factors leave a margin of ten and more, measured with squares from 1e-6 to 1e4 m
/// (tests/unit/cpu_lights, validation/suite: all_sizes). The coordinates of the POINT do not enter: a large triangle is as
/// imprecise near the origin as elsewhere, and a small one there as precise as its corners.
/// largest  per axis: the largest |coordinate| of what the point lies on
inline float surface_offset(glm::vec3 largest, glm::vec3 unit_normal) {
  constexpr float kAlongNormal = 1.0f / 262144.0f, kAcross = 1.0f / 2097152.0f;  // 2^-18, 2^-21
  const float along = std::fabs(unit_normal.x) * largest.x + std::fabs(unit_normal.y) * largest.y +
                      std::fabs(unit_normal.z) * largest.z;
  return kAlongNormal * along + kAcross * std::max(std::max(largest.x, largest.y), largest.z);
}

inline glm::vec3 largest_coordinates(glm::vec3 p0, glm::vec3 p1, glm::vec3 p2) {
  return glm::max(glm::max(glm::abs(p0), glm::abs(p1)), glm::abs(p2));
}

/// Of a sphere, disk or cylinder: no point of it has a larger one.
inline glm::vec3 largest_coordinates(const KbShape& shape) {
  glm::vec3 largest;
  for (int axis = 0; axis < 3; ++axis) {
    const float* row = &shape.to_world[4 * axis];
    largest[axis] = std::fabs(row[3]) + std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]);
  }
  return largest;
}

/// How far before a light's surface a shadow ray ends: the test of its triangle is as wrong as above, and by the
/// distance besides.
inline float target_offset(float offset, glm::vec3 to_light) {
  const glm::vec3 a = glm::abs(to_light);
  return offset + (1.0f / 1048576.0f) * std::max(std::max(a.x, a.y), a.z);  // 2^-20
}

inline glm::vec3 offset_ray_origin(glm::vec3 p, glm::vec3 unit_normal, float offset) {
  return p + offset * unit_normal;
}

}  // namespace kiloband
