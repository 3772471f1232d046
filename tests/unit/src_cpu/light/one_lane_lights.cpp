#include "src_cpu/lanes/one_lane.hpp"
// After the lanes that it is to be compiled for.
#include "light_lanes-inl.hpp"

namespace kiloband::test {

const std::vector<SceneFunction>& scene_functions_of_one_lane() {
  static const std::vector<SceneFunction> functions = cpu::one_lane::scene_functions();
  return functions;
}

}  // namespace kiloband::test
