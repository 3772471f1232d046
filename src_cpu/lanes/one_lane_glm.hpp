// Between glm's vectors and those of one lane.
#pragma once

#include <glm/glm.hpp>

#include "src_cpu/lanes/one_lane.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/lanes/vector3-inl.hpp"

namespace kiloband::cpu {

inline one_lane::V3 to_lane(glm::vec3 v) {
  return {v.x, v.y, v.z};
}
inline one_lane::V2 to_lane(glm::vec2 v) {
  return {v.x, v.y};
}
inline glm::vec3 to_glm(one_lane::V3 v) {
  return {v.x.v, v.y.v, v.z.v};
}
inline glm::vec2 to_glm(one_lane::V2 v) {
  return {v.x.v, v.y.v};
}

}  // namespace kiloband::cpu
