#include <stdexcept>

#include "lane_functions.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/src_cpu/lanes/vector_functions.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include "src_cpu/lanes/highway_lanes-inl.hpp"
// After the lanes that it is to be compiled for.
#include "lane_functions-inl.hpp"

#if HWY_ONCE
namespace kiloband::test {

// Each table is made where it is asked for: the code that makes it is code of its instruction set.
const std::vector<NamedFunction>& functions_of(cpu::Isa isa) {
  switch (isa) {
#if HWY_TARGETS & HWY_AVX3
    case cpu::Isa::kAvx512: {
      static const std::vector<NamedFunction> functions = cpu::N_AVX3::named_functions();
      return functions;
    }
#endif
#if HWY_TARGETS & HWY_AVX2
    case cpu::Isa::kAvx2: {
      static const std::vector<NamedFunction> functions = cpu::N_AVX2::named_functions();
      return functions;
    }
#endif
#if HWY_TARGETS & HWY_SSE4
    case cpu::Isa::kSse4: {
      static const std::vector<NamedFunction> functions = cpu::N_SSE4::named_functions();
      return functions;
    }
#endif
    default:
      throw std::logic_error("functions_of: the instruction set is not resolved");
  }
}

}  // namespace kiloband::test
#endif
