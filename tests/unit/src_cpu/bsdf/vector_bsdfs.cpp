#include <stdexcept>

#include "bsdf_functions.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/src_cpu/bsdf/vector_bsdfs.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include "src_cpu/lanes/highway_lanes-inl.hpp"
// After the lanes that it is to be compiled for.
#include "bsdf_functions-inl.hpp"

#if HWY_ONCE
namespace kiloband::test {

LaneAnswers answers_of(cpu::Isa isa, const LaneQueries& queries) {
  switch (isa) {
#if HWY_TARGETS & HWY_AVX3
    case cpu::Isa::kAvx512:
      return cpu::N_AVX3::answer_queries(queries);
#endif
#if HWY_TARGETS & HWY_AVX2
    case cpu::Isa::kAvx2:
      return cpu::N_AVX2::answer_queries(queries);
#endif
#if HWY_TARGETS & HWY_SSE4
    case cpu::Isa::kSse4:
      return cpu::N_SSE4::answer_queries(queries);
#endif
    default:
      throw std::logic_error("answers_of: the instruction set is not resolved");
  }
}

}  // namespace kiloband::test
#endif
