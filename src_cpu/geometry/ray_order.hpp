// Rays of a wave in an order in which neighbours go similar ways.
#pragma once

#include <algorithm>
#include <array>

#include "src_cpu/geometry/ray_queue.hpp"

namespace kiloband::cpu {

/// The box of the geometry, m.
struct RayBox {
  float low[3], high[3];
};

inline constexpr uint32_t kRayCells = 4;  // along each axis of the box

/// Which of the box's cells a coordinate lies in; outside of the box, and for NaN, one at its border.
inline uint32_t ray_cell(float x, float low, float high) {
  const float place = (x - low) / (high - low) * kRayCells;
  return place >= 1 ? static_cast<uint32_t>(std::min(place, static_cast<float>(kRayCells - 1))) : 0u;
}

/// Fills order[0 .. rays.count): by the octant of the direction, then by the cell that the ray begins in. Stable, so that
/// the order follows from the rays alone.
/// Queue  RayQueue or ShadowQueue
template <class Queue>
void sort_rays(const Queue& rays, const RayBox& box, uint32_t* order) {
  constexpr uint32_t kKeys = 8 * kRayCells * kRayCells * kRayCells;
  std::array<uint16_t, kQueueCapacity> key;
  std::array<uint32_t, kKeys + 1> begin{};
  for (uint32_t i = 0; i < rays.count; ++i) {
    const uint32_t octant =
        (rays.dx[i] < 0 ? 1u : 0u) | (rays.dy[i] < 0 ? 2u : 0u) | (rays.dz[i] < 0 ? 4u : 0u);
    const uint32_t x = ray_cell(rays.ox[i], box.low[0], box.high[0]);
    const uint32_t y = ray_cell(rays.oy[i], box.low[1], box.high[1]);
    const uint32_t z = ray_cell(rays.oz[i], box.low[2], box.high[2]);
    key[i] = static_cast<uint16_t>(((octant * kRayCells + z) * kRayCells + y) * kRayCells + x);
    ++begin[key[i] + 1u];
  }
  for (uint32_t k = 0; k < kKeys; ++k) begin[k + 1] += begin[k];
  for (uint32_t i = 0; i < rays.count; ++i) order[begin[key[i]]++] = i;
}

}  // namespace kiloband::cpu
