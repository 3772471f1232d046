// Highway's kernels on every instruction set that they are compiled for and the processor has.
#pragma once

#include <cstdint>

// The sets come before Highway, which with KILOBAND_NATIVE would take one that nothing is compiled for.
// clang-format off
#include "base/simd_targets.hpp"
#include <hwy/highway.h>
// clang-format on

namespace kiloband::test {

/// f for each instruction set.
template <class F>
void on_every_target(F&& f) {
  for (const int64_t target : {HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
    if (!(hwy::SupportedTargets() & target)) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    f();
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
}

}  // namespace kiloband::test
