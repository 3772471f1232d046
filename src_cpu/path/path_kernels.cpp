#include "src_cpu/path/path_kernels.hpp"

#include <stdexcept>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src_cpu/path/path_kernels.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include "src_cpu/lanes/highway_lanes-inl.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/bsdf/spectral_mis-inl.hpp"
#include "src_cpu/geometry/few_triangles-inl.hpp"
#include "src_cpu/path/shade-inl.hpp"
#include "src_cpu/path/start-inl.hpp"

namespace kiloband::cpu {
namespace HWY_NAMESPACE {

inline constexpr PathKernels kPathKernels{start_wave, shade_wave, closest_of_few, occlusions_of_few,
                                          eval_heroes};

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu

#if HWY_ONCE
namespace kiloband::cpu {

const PathKernels& path_kernels(Isa isa) {
  const PathKernels* const of_isa[] = {nullptr, HWY_CHOOSE_SSE4(kPathKernels), HWY_CHOOSE_AVX2(kPathKernels),
                                       HWY_CHOOSE_AVX3(kPathKernels)};
  const auto* const kernels = of_isa[static_cast<int>(isa)];
  if (!kernels) throw std::logic_error("path_kernels: the instruction set is not resolved");
  return *kernels;
}

}  // namespace kiloband::cpu
#endif
