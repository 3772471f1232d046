#include <gtest/gtest.h>

#include "validation/speed/subject.hpp"

namespace kiloband::speed {
namespace {

TEST(ImageSide, ProcessorsHaveSmallImages) {
  for (const uint32_t channels : {1u, 512u, 4096u}) {
    EXPECT_EQ(image_side(false, true, channels), 64u);
    EXPECT_EQ(image_side(false, false, channels), 128u);
  }
}

TEST(ImageSide, GpusHaveLargerOnesWhoseFilmsFit) {
  EXPECT_EQ(image_side(true, true, 8), 256u);
  EXPECT_EQ(image_side(true, false, 8), 512u);
  EXPECT_EQ(image_side(true, false, 512), 512u);
  EXPECT_EQ(image_side(true, false, 513), 256u);
  EXPECT_EQ(image_side(true, false, 4096), 128u);
  EXPECT_EQ(image_side(true, false, 1'000'000), 64u);
}

/// Without OpenCL no device is asked for.
TEST(ImageSide, OfARunWithoutOpencl) {
  Settings settings;
  settings.backends = {"cpu"};
  settings.device = "no such device";
  EXPECT_EQ(image_side(Bench(settings, Watch{}), 8), 128u);
}

}  // namespace
}  // namespace kiloband::speed
