// Where a ray leaves a surface: off it by an amount that follows floating point precision, not the scene's
// size.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>

namespace kiloband {

/// Moves p to the side that unit_normal points to, far enough that a ray from there does not hit the surface
/// p is on. Away from 0 a coordinate moves by 256 units in the last place times the normal's coordinate;
/// below 1/32, where these units shrink but the error of a hit does not, by 1/65536 times it. source
/// Waechter, Binder: A Fast and Robust Method for Avoiding Self-Intersection, Ray Tracing Gems (2019), ch. 6
inline glm::vec3 offset_ray_origin(glm::vec3 p, glm::vec3 unit_normal) {
  constexpr float kNearZero = 1.0f / 32.0f, kAbsolute = 1.0f / 65536.0f, kUlps = 256.0f;
  glm::vec3 moved;
  for (int axis = 0; axis < 3; ++axis) {
    const float x = p[axis];
    if (std::fabs(x) < kNearZero) {
      moved[axis] = x + kAbsolute * unit_normal[axis];
      continue;
    }
    // Adding to the bits of a float moves it away from 0: the sign of x turns that into a direction.
    const auto steps = static_cast<int32_t>(kUlps * unit_normal[axis]);
    uint32_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    bits += static_cast<uint32_t>(x < 0 ? -steps : steps);
    std::memcpy(&moved[axis], &bits, sizeof bits);
  }
  return moved;
}

}  // namespace kiloband
