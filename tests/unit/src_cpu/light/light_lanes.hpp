// Lights, textures and cameras over arrays, compiled for one lane and for every instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/lanes/isa.hpp"

namespace kiloband::test {

/// in, out: arrays of `count` numbers each; count is a multiple of 16. Words travel as the bits of floats.
struct SceneFunction {
  const char* name;
  uint32_t inputs, outputs;
  void (*apply)(const FlatScene& scene, const float* const* in, float* const* out, std::size_t count);
};

/// All of them, in the same order.
const std::vector<SceneFunction>& scene_functions_of_one_lane();
const std::vector<SceneFunction>& scene_functions_of(cpu::Isa isa);

}  // namespace kiloband::test
