// What path vertices hold as numbers.
#include "shared/path_vertex.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

namespace kiloband::test::path_vertex_test {
namespace {

/// Subnormal results and operands become 0 while this lives, as in the renderer's threads.
class FlushedSubnormals {
 public:
  FlushedSubnormals() { _mm_setcsr(before_ | 0x8040u); }
  ~FlushedSubnormals() { _mm_setcsr(before_); }

 private:
  unsigned before_ = _mm_getcsr();
};

/// A compiler may put in a division by 1, or a sum with 0, where the code has neither.
TEST(PathVertex, ChannelNumbersSurviveArithmeticThatFlushesSubnormals) {
  const FlushedSubnormals flushed;
  for (kb_u32 channel = 0; channel < (1u << 24); channel = channel < 5000 ? channel + 1 : channel * 2 - 1) {
    volatile float weight = kb_channel_weight(channel), one = 1, zero = 0;
    weight = weight / one;
    weight = weight * one + zero;
    ASSERT_EQ(kb_surviving_channel(weight), channel);
  }
}

}  // namespace
}  // namespace kiloband::test::path_vertex_test
