// Small helpers that the parts of the path tracer share.
#pragma once

#include <cstdint>
#include <limits>

namespace kiloband::cpu {

inline constexpr float kInfiniteDistance = std::numeric_limits<float>::infinity();

/// Veach's power heuristic with beta = 2: the weight of the technique with density pdf against one with
/// density other. Safe for densities whose squares would overflow.
inline float power_heuristic(float pdf, float other) {
  if (!(pdf < kInfiniteDistance)) return 1;
  const float ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

}  // namespace kiloband::cpu
