// The rays of a wave of paths, in structures of arrays: what Embree's packets are filled from, and lanes read.
#pragma once

#include <cstdint>

namespace kiloband::cpu {

/// Paths that advance together, bounce by bounce: one sample of a block of 32 x 32 pixels.
inline constexpr uint32_t kWavePaths = 1024;
/// Whole vectors are written past the last one; no power of two, so that arrays do not share cache sets.
inline constexpr uint32_t kQueueCapacity = kWavePaths + 48;

/// Closest-hit queries and their answers. Directions need not be unit vectors; hits lie in (t_min, t_max).
struct alignas(64) RayQueue {
  float ox[kQueueCapacity], oy[kQueueCapacity], oz[kQueueCapacity], t_min[kQueueCapacity];
  float dx[kQueueCapacity], dy[kQueueCapacity], dz[kQueueCapacity];
  float t_max[kQueueCapacity];                 // in: far end; out: the hit's distance
  float u[kQueueCapacity], v[kQueueCapacity];  // barycentric coordinates of a mesh hit
  uint32_t primitive[kQueueCapacity];          // triangle within the shape
  uint32_t shape[kQueueCapacity];              // KB_NONE: a miss
  uint32_t path[kQueueCapacity];               // whose ray it is: index in the wave
  uint32_t count = 0;
};

/// Occlusion queries from t_min 0. Null boundaries hide nothing.
struct alignas(64) ShadowQueue {
  float ox[kQueueCapacity], oy[kQueueCapacity], oz[kQueueCapacity];
  float dx[kQueueCapacity], dy[kQueueCapacity], dz[kQueueCapacity];
  float t_max[kQueueCapacity];     // in: far end; out: negative where something is in between
  uint32_t entry[kQueueCapacity];  // the vertex that has the light sample
  uint32_t path[kQueueCapacity];   // whose ray it is; a path has one at most
  /// Out, only in scenes with null boundaries: 1 where the ray has met one; where it is hidden, perhaps.
  uint32_t passes[kQueueCapacity];
  uint32_t count = 0;
};

/// Rays that have hit nothing.
struct alignas(64) EscapeQueue {
  float dx[kQueueCapacity], dy[kQueueCapacity], dz[kQueueCapacity];
  uint32_t path[kQueueCapacity];
  uint32_t count = 0;
};

/// How rays are put into packets.
enum class RayPackets {
  kCoherent,   // of 16: camera rays as they stand, and sorted rays (ray_order.hpp)
  kIncoherent  // of 8, shadow rays 16: the answers are those of single rays, bit for bit
};

}  // namespace kiloband::cpu
