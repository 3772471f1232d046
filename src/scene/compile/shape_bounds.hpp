// Bounds of analytic shapes, for both backends' acceleration structures, and their areas.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <utility>

#include "shared/records.h"

namespace kiloband {

/// Interval that an analytic shape covers along one axis (0, 1, 2), scene units, from that row of its
/// to_world: a circle or sphere of unit radius reaches |row| to both sides; a cylinder also spans its axis.
/// Grown by 1e-6 of its size and place, so that rounding to float loses nothing.
inline std::pair<float, float> analytic_interval(const KbShape& shape, int axis) {
  const float* row = &shape.to_world[4 * axis];
  const double round = row[0] * double{row[0]} + row[1] * double{row[1]};
  const double reach = std::sqrt(shape.type == KB_SHAPE_SPHERE ? round + row[2] * double{row[2]} : round);
  const double along = shape.type == KB_SHAPE_CYLINDER ? row[2] : 0;
  const double from = row[3] + std::min(0.0, along) - reach;
  const double to = row[3] + std::max(0.0, along) + reach;
  const double slack = 1e-6 * std::max({std::abs(from), std::abs(to), reach});
  return {static_cast<float>(from - slack), static_cast<float>(to + slack)};
}

/// Surface area of a canonical analytic shape under its transform (a similarity for spheres; see the reader's checks).
inline double analytic_area(uint32_t type, const glm::dmat4& to_world) {
  const glm::dvec3 x(to_world[0]), y(to_world[1]), z(to_world[2]);
  const double pi = std::numbers::pi;
  if (type == KB_SHAPE_SPHERE) return 4 * pi * glm::dot(x, x);
  if (type == KB_SHAPE_DISK) return pi * glm::length(glm::cross(x, y));
  return 2 * pi * glm::length(x) * glm::length(z);
}

}  // namespace kiloband
