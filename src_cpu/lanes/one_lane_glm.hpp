// Between glm's vectors, arrays and the vectors of one lane.
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
inline void put(one_lane::V3 v, float (&to)[3]) {
  to[0] = v.x.v, to[1] = v.y.v, to[2] = v.z.v;
}

}  // namespace kiloband::cpu
