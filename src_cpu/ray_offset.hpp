// Where a ray leaves a surface: off it by an amount that follows floating point precision, not the scene's
// size.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband {

/// How far off a surface rays begin, in m: far enough that a ray from there does not find the surface it
/// left.
///
/// With u = 2^-24, a point on a triangle and the plane through it that an intersection test sees are wrong by
/// a few u times the corners' coordinates, each in its axis' share of the normal: a level plane is exact,
/// however wide, where its height is. Tests that turn the triangle into the ray's frame mix the axes: another
/// u or two of the largest coordinate. The factors leave a margin of ten and more, measured with squares from
/// 1e-6 to 1e4 m (tests/unit/cpu_lights, validation/suite: all_sizes). The coordinates of the POINT do not
/// enter: a large triangle is as imprecise near the origin as elsewhere, and a small one there as precise as
/// its corners. largest  per axis: the largest |coordinate| of what the point lies on
inline float surface_offset(glm::vec3 largest, glm::vec3 unit_normal) {
  constexpr float kAlongNormal = 1.0f / 524288.0f, kAcross = 1.0f / 4194304.0f;  // 2^-19, 2^-22
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

/// How far before a light's surface a shadow ray ends: the test of its triangle is as wrong as above, and by
/// the distance besides.
inline float target_offset(float offset, glm::vec3 to_light) {
  const glm::vec3 a = glm::abs(to_light);
  return offset + (1.0f / 1048576.0f) * std::max(std::max(a.x, a.y), a.z);  // 2^-20
}

/// Weights of a triangle's second and third corner, kept `offset` * 8 away from its edges (in slivers as far
/// as an eighth of the height): a point that is rounded across an edge lies outside of the neighbour, and a
/// ray from there leaves a closed body unseen; so does one that is moved off the triangle along the normal
/// next to a neighbour at an acute angle (up to atan(1/8) = 7 degrees). Before, 1 of 10^6 ... 10^8 rays did.
inline glm::vec2 off_the_edges(glm::vec3 p0, glm::vec3 p1, glm::vec3 p2, float area2, float offset,
                               glm::vec2 b) {
  const glm::vec3 e1 = p1 - p0, e2 = p2 - p0, e3 = p2 - p1;
  const float longest = std::sqrt(std::max(std::max(glm::dot(e1, e1), glm::dot(e2, e2)), glm::dot(e3, e3)));
  const float least = std::min(8.0f * offset * longest / area2, 0.125f);
  const float w = std::max(1 - b.x - b.y, least), u = std::max(b.x, least), v = std::max(b.y, least);
  const float sum = w + u + v;
  return {u / sum, v / sum};
}

/// The same for disks and cylinders, which close bodies with others at their rims.
/// uv  of the point, as SurfacePoint has it: a disk's u is the radius, a cylinder's v the height
inline glm::vec3 off_the_rim(const KbShape& shape, glm::vec3 p, glm::vec2 uv, float offset) {
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

inline glm::vec3 offset_ray_origin(glm::vec3 p, glm::vec3 unit_normal, float offset) {
  return p + offset * unit_normal;
}

}  // namespace kiloband
