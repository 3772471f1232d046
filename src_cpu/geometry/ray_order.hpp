// Rays of a wave in an order in which neighbours go similar ways.
#pragma once

#include <bit>

#include "src_cpu/geometry/ray_queue.hpp"

namespace kiloband::cpu {

inline constexpr uint32_t kRayCells = 4;  // along each axis of the box of the geometry

/// The cells of a box, which rays begin in.
struct RayGrid {
  float low[3] = {};    // m
  float scale[3] = {};  // cells per m

  RayGrid() = default;
  RayGrid(const float (&lowest)[3], const float (&highest)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = lowest[axis];
      const float extent = highest[axis] - lowest[axis];
      scale[axis] = extent > 0 ? static_cast<float>(kRayCells) / extent : 0;
    }
  }
};

/// Which cell along an axis; outside of the box one at its border, for NaN the first.
inline int32_t ray_cell(float x, float low, float scale) {
  const float place = (x - low) * scale;
  const float within = place > 0 ? place : 0;
  constexpr float kLast = kRayCells - 1;
  return static_cast<int32_t>(within < kLast ? within : kLast);
}

/// The octant of a ray's direction, then the cell that it begins in.
template <class Queue>
void fill_ray_keys(const Queue& rays, const RayGrid& grid, uint32_t* key) {
  const auto sign = [](float d) { return std::bit_cast<uint32_t>(d) >> 31; };
  for (uint32_t i = 0; i < rays.count; ++i) {
    const uint32_t octant = sign(rays.dx[i]) | sign(rays.dy[i]) << 1 | sign(rays.dz[i]) << 2;
    const auto x = static_cast<uint32_t>(ray_cell(rays.ox[i], grid.low[0], grid.scale[0]));
    const auto y = static_cast<uint32_t>(ray_cell(rays.oy[i], grid.low[1], grid.scale[1]));
    const auto z = static_cast<uint32_t>(ray_cell(rays.oz[i], grid.low[2], grid.scale[2]));
    key[i] = ((octant * kRayCells + z) * kRayCells + y) * kRayCells + x;
  }
}

/// Copies what is asked, not the answers.
inline void copy_query(const RayQueue& from, uint32_t i, RayQueue& to, uint32_t at) {
  to.ox[at] = from.ox[i], to.oy[at] = from.oy[i], to.oz[at] = from.oz[i];
  to.dx[at] = from.dx[i], to.dy[at] = from.dy[i], to.dz[at] = from.dz[i];
  to.t_min[at] = from.t_min[i], to.t_max[at] = from.t_max[i];
  to.path[at] = from.path[i];
}
inline void copy_query(const ShadowQueue& from, uint32_t i, ShadowQueue& to, uint32_t at) {
  to.ox[at] = from.ox[i], to.oy[at] = from.oy[i], to.oz[at] = from.oz[i];
  to.dx[at] = from.dx[i], to.dy[at] = from.dy[i], to.dz[at] = from.dz[i];
  to.t_max[at] = from.t_max[i];
  to.entry[at] = from.entry[i], to.path[at] = from.path[i];
}

/// Copies the queries to `to`, by octant and cell. Stable, so that the order follows from the rays alone.
/// Queue  RayQueue or ShadowQueue
template <class Queue>
void sort_rays(const Queue& from, const RayGrid& grid, Queue& to) {
  constexpr uint32_t kKeys = 8 * kRayCells * kRayCells * kRayCells;
  alignas(64) uint32_t key[kQueueCapacity];
  uint32_t begin[kKeys + 1] = {};
  fill_ray_keys(from, grid, key);
  for (uint32_t i = 0; i < from.count; ++i) ++begin[key[i] + 1];
  for (uint32_t k = 0; k < kKeys; ++k) begin[k + 1] += begin[k];
  for (uint32_t i = 0; i < from.count; ++i) copy_query(from, i, to, begin[key[i]]++);
  to.count = from.count;
}

}  // namespace kiloband::cpu
