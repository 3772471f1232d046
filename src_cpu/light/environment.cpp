// Environment maps for one direction at a time: environment-inl.hpp for one lane.
#include "src_cpu/light/environment.hpp"

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/environment-inl.hpp"

namespace kiloband::cpu {

glm::vec2 envmap_coordinates(const KbEmitter& emitter, glm::vec3 direction) {
  return to_glm(one_lane::envmap_coordinates(emitter, to_lane(direction)));
}

float envmap_density(const EnvmapSampling& sampling, glm::vec2 uv, uint32_t facing) {
  return one_lane::envmap_density(sampling, to_lane(uv), facing).v;
}

uint32_t environment_facing(const KbEmitter& emitter, glm::vec3 normal) {
  return one_lane::facing_of(emitter, to_lane(normal)).v;
}

}  // namespace kiloband::cpu
