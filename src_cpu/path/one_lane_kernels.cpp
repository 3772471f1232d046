#include "src_cpu/lanes/one_lane.hpp"
#include "src_cpu/path/path_kernels.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/bsdf/spectral_mis-inl.hpp"
#include "src_cpu/geometry/few_triangles-inl.hpp"
#include "src_cpu/path/shade-inl.hpp"
#include "src_cpu/path/start-inl.hpp"

namespace kiloband::cpu {

const PathKernels& one_lane_path_kernels() {
  static constexpr PathKernels kKernels{one_lane::start_wave, one_lane::shade_wave, one_lane::closest_of_few,
                                        one_lane::occlusions_of_few, one_lane::eval_heroes};
  return kKernels;
}

void shade_rare_rays(const Bounce& bounce, Wave& wave) {
  one_lane::shade_rare_rays(bounce, wave);
}

}  // namespace kiloband::cpu
