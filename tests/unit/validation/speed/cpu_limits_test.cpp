// The limits of a CPU thread, as measured.
#include "validation/speed/cpu_limits.hpp"

#include <gtest/gtest.h>

namespace kiloband::test::cpu_limits_test {
namespace {

/// Two operations per lane and cycle at least, four at most on any core with two multiply-add units: cores have 0.5 to 6 GHz. Wider vectors
/// are not slower; the best of 20 attempts of some milliseconds is little troubled by what else runs.
TEST(CpuLimits, PeaksAreThoseOfVectors) {
  double narrower = 0;
  double lanes = 4;
  for (const cpu::Isa isa : {cpu::Isa::kSse4, cpu::Isa::kAvx2, cpu::Isa::kAvx512}) {
    if (cpu::is_available(isa)) {
      const double peak = speed::peak_flops_of_thread(isa);
      EXPECT_GT(peak, 2 * lanes * 0.25e9) << to_string(isa);
      EXPECT_LT(peak, 4 * lanes * 6e9) << to_string(isa);
      EXPECT_GT(peak, 0.8 * narrower) << to_string(isa);
      narrower = peak;
    }
    lanes *= 2;
  }
}

}  // namespace
}  // namespace kiloband::test::cpu_limits_test
