// Where a ray leaves a surface: off it by an amount that follows floating point precision,
// not the scene's size.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband::cpu {

/// How far off a surface rays begin, in m: far enough that a ray from there does not find
/// the surface it left.
///
/// With u = 2^-24, a point on a triangle and the plane through it that an intersection test sees are wrong by
/// a few u times the corners' coordinates, each in its axis' share of the normal: a level plane is exact,
/// however wide, where its height is. Tests that turn the triangle into the ray's frame mix the axes: another
/// u or two of the largest coordinate. With squares from 1e-6 to 1e4 m (tests/unit/src_cpu/light,
/// validation/suite: all_sizes) an eighth of the factor along the normal still sufficed; the factor across
/// has no measured lower bound. The coordinates of the POINT do not enter: a large triangle is as imprecise
/// near the origin as elsewhere, and a small one there as precise as its corners.
/// largest  per axis: the largest |coordinate| of what the point lies on
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

/// The seldom part of off_the_edges(). area2: twice the triangle's area; least: distance from the edges, m
inline glm::vec3 moved_off_the_edges(glm::vec3 p, const glm::vec3 (&corners)[3], glm::vec3 area_normal,
                                     float area2, float least) {
  if (!(area2 > 0)) return p;
  glm::vec3 moved = p;
  float share = 0;  // of the way to the centroid
  int near = 0;
  for (int i = 0; i < 3; ++i) {
    const glm::vec3 edge = corners[(i + 1) % 3] - corners[i];
    const float length = std::sqrt(glm::dot(edge, edge)), height = area2 / length;
    const glm::vec3 inwards = glm::cross(area_normal, edge) / (area2 * length);
    const float wanted = std::min(least, height / 8.0f), missing = wanted - glm::dot(p - corners[i], inwards);
    if (!(missing > 0)) continue;
    ++near;
    moved = p + missing * inwards;
    share = std::max(share, missing / (missing + height / 3.0f - wanted));  // the centroid is a third high
  }
  return near > 1 ? p + share * ((corners[0] + corners[1] + corners[2]) / 3.0f - p) : moved;
}

/// A point of a triangle, moved in its plane to at least 8 offsets from its edges (in slivers an eighth of
/// the height). A point that is rounded across an edge lies outside of the neighbour, and a ray from there
/// leaves a closed body unseen; so does one that is moved off the triangle next to a neighbour at an acute
/// angle (up to atan(1/8) = 7 degrees). Without this, 1 of 10^6 to 10^8 rays left such bodies.
/// weights      barycentric, of the three corners
/// area_normal  cross product of the edges from p0
inline glm::vec3 off_the_edges(glm::vec3 p, glm::vec3 weights, const glm::vec3 (&corners)[3],
                               glm::vec3 area_normal, float offset) {
  const float least = 8.0f * offset, smallest = std::min(std::min(weights.x, weights.y), weights.z);
  const glm::vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
  const float area2_squared = glm::dot(area_normal, area_normal);
  // The distance from an edge is weight * area2 / its length; the third edge, squared, is at most this long.
  const float long2 = 2.0f * (glm::dot(e1, e1) + glm::dot(e2, e2));
  if (smallest > 0 && smallest * smallest * area2_squared > least * least * long2) return p;  // nearly always
  return moved_off_the_edges(p, corners, area_normal, std::sqrt(area2_squared), least);
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

}  // namespace kiloband::cpu
