#include <stdexcept>

#include "bsdf_functions.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/src_cpu/bsdf/vector_bsdfs.cpp"
#define HWY_DISABLED_TARGETS (HWY_SCALAR | HWY_EMU128 | HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include "src_cpu/lanes/highway_lanes-inl.hpp"
// After the lanes that it is to be compiled for.
#include "bsdf_functions-inl.hpp"

#if HWY_ONCE
namespace kiloband::test {

LaneAnswers answers_of(cpu::Isa isa, const LaneQueries& queries) {
  switch (isa) {
    case cpu::Isa::kAvx512:
      return cpu::N_AVX3::answer_queries(queries);
    case cpu::Isa::kAvx2:
      return cpu::N_AVX2::answer_queries(queries);
    case cpu::Isa::kSse4:
      return cpu::N_SSE4::answer_queries(queries);
    default:
      throw std::logic_error("answers_of: the instruction set is not resolved");
  }
}

}  // namespace kiloband::test
#endif
