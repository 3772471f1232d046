#include "stats/tails.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/simulated_image.hpp"

namespace kiloband::stats::tails_test {
namespace {

std::vector<TailWeight> tails_of(const ReplicateImage& image) {
  Tails tails(image.channels);
  UnitSample pixel;
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    gather_pixel(image, p, pixel);
    tails.add(pixel);
  }
  return tails.finish();
}

/// A third of normal deviates carry the variance (E d^4 = 3 (E d^2)^2); about the median of 32 a little less.
TEST(Tails, NormalNoise) {
  const TailWeight t = tails_of(simulate({64, 64, 32, 1}, test::BatchPool("normal", 1), 1))[0];
  EXPECT_EQ(t.count, 64u * 64 * 32);
  EXPECT_NEAR(t.effective / static_cast<double>(t.count), 1.0 / 3, 0.02);
  EXPECT_LT(t.top_variance, 3e-4);
  EXPECT_GT(t.hill_index, 5);
}

/// Pareto samples of index 2.1: Hill's estimate from the largest 130 has a standard error of 9 %; deviations
/// from the median shift it a little.
TEST(Tails, ParetoIndex) {
  const TailWeight t = tails_of(simulate({64, 64, 32, 1, 1}, test::BatchPool("pareto", 1, 1 << 20), 2))[0];
  EXPECT_NEAR(t.hill_index, 2.1, 0.6);
  EXPECT_LT(t.effective / static_cast<double>(t.count), 0.05);
}

/// One firefly of 1e5 times the mean.
TEST(Tails, OneFirefly) {
  ReplicateImage image = simulate({16, 16, 8, 2}, test::BatchPool("exponential", 4), 3);
  image.means[100] = 1e5f;  // channel 0
  const std::vector<TailWeight> t = tails_of(image);
  EXPECT_EQ(heaviest_channel(t), 0u);
  EXPECT_NEAR(t[0].effective, 1, 0.01);
  EXPECT_GT(t[0].top_variance, 0.999);
  EXPECT_NEAR(t[0].top_sum, 1e5 / (1e5 + 16 * 16 * 8), 0.02);
  EXPECT_GT(t[1].effective, 100);
}

}  // namespace
}  // namespace kiloband::stats::tails_test
