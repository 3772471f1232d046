// Means with variances and nothing else.
#include "stats/comparison/moment_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "stats/distributions.hpp"
#include "tests/support/simulated_image.hpp"

namespace kiloband::stats::moment_comparison_test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

MomentImage one_pixel(float mean, float variance, double dof) {
  return {1, 1, 1, dof, {mean}, {variance}};
}

Comparison compare(const MomentImage& a, const MomentImage& b, bool independent = false) {
  MomentComparison comparison(a.width, a.height, a.channels, independent, {});
  comparison.add(a, b);
  return comparison.finish();
}

TEST(Moments, BehrensFisherAndNormalByHand) {
  const Comparison known = compare(one_pixel(5, 0.75f, 15), one_pixel(4, 0.25f, 5));
  EXPECT_NEAR(known.tests[0].p, behrens_fisher_p(1 - 5e-5, 0.75, 15, 5), 1e-9);
  const Comparison normal = compare(one_pixel(5, 0.75f, kInfinite), one_pixel(4, 0.25f, kInfinite));
  EXPECT_NEAR(normal.tests[0].p, student_p(1 - 5e-5, kInfinite), 1e-9);
  EXPECT_EQ(known.tests.size(), 1u) << "pixels alone";
  EXPECT_EQ(known.notes.size(), 2u);
}

/// The pixels' moments of replicates are those of the replicates' own comparison.
TEST(Moments, AgreeWithReplicates) {
  const test::BatchPool pool("normal", 4);
  const ReplicateImage a = simulate({12, 9, 16, 1}, pool, 1), b = simulate({12, 9, 16, 1}, pool, 2);
  const Comparison moments = compare(moments_of(a), moments_of(b)), full = compare_independent(a, b, {});
  EXPECT_NEAR(moments.means[0].worst.p / full.means[0].worst.p, 1, 1e-3);
  EXPECT_EQ(moments.means[0].worst.place.x, full.means[0].worst.place.x);
}

TEST(Moments, PixelsPoolOnlyIfIndependent) {
  const test::BatchPool pool("normal", 4);
  test::SimulatedImage shape{24, 24, 16, 2};
  const ReplicateImage a = simulate(shape, pool, 1);
  shape.mean = [](uint32_t, uint32_t, std::size_t) { return 1.05; };
  const ReplicateImage b = simulate(shape, pool, 2);
  EXPECT_TRUE(compare(moments_of(a), moments_of(b)).passed)
      << "5 % of every pixel are not seen pixel by pixel";
  const Comparison pooled = compare(moments_of(a), moments_of(b), true);
  EXPECT_EQ(pooled.decisive().name, "mean/image");
  EXPECT_FALSE(pooled.passed);
  EXPECT_NEAR(pooled.image_error[0], compare_independent(a, b, {}).image_error[0],
              0.3 * pooled.image_error[0]);
}

/// Without noise on either side: 4 replicates may agree by chance in a pixel, not in most of a tile.
TEST(Moments, VariancesOfReplicatesThatAgree) {
  const auto image = [](std::size_t different, double dof) {
    MomentImage moments{8, 16, 1, dof, std::vector<float>(128, 1), std::vector<double>(128)};
    for (std::size_t p = 0; p < different; ++p) moments.mean[p] = 1.01f;
    return moments;
  };
  for (const bool independent : {false, true}) {
    const auto passed = [&](std::size_t different, double dof) {
      return compare(image(0, dof), image(different, dof), independent).passed;
    };
    EXPECT_TRUE(passed(0, 3));
    EXPECT_TRUE(passed(32, 3));
    EXPECT_FALSE(passed(33, 3));
    EXPECT_FALSE(passed(1, 15));
    EXPECT_FALSE(passed(1, kInfinite));
  }
}

TEST(Moments, MissingPixels) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(compare({2, 1, 1, 9, {1, none}, {1, none}}, {2, 1, 1, 9, {1, none}, {1, none}}).passed);
  const Comparison one_side = compare({2, 1, 1, 9, {1, none}, {1, none}}, {2, 1, 1, 9, {1, 1}, {1, 1}});
  EXPECT_EQ(one_side.decisive().name, "finite");
  const Comparison no_error = compare({2, 1, 1, 9, {1, 1}, {1, none}}, {2, 1, 1, 9, {1, 1}, {1, 1}});
  EXPECT_TRUE(no_error.passed);
  EXPECT_EQ(no_error.means[0].entries.unsampled, 1u);
}

/// Means whose squares no float holds: the same result as at 1, not variances that are 0 or infinite.
TEST(Moments, TinyAndHugeValues) {
  const test::BatchPool pool("normal", 4);
  const auto result = [&](float scale) {
    ReplicateImage a = simulate({12, 9, 16, 1}, pool, 1), b = simulate({12, 9, 16, 1}, pool, 2);
    for (ReplicateImage* image : {&a, &b}) {
      for (float& value : image->means) value *= scale;
    }
    return compare(moments_of(a), moments_of(b));
  };
  const Comparison one = result(1);
  EXPECT_TRUE(one.passed);
  for (const float scale : {0x1p-100f, 0x1p-70f, 0x1p100f}) {
    const Comparison scaled = result(scale);
    EXPECT_NEAR(scaled.tests[0].p, one.tests[0].p, 1e-6) << scale;
    EXPECT_EQ(scaled.means[0].entries.tested, one.means[0].entries.tested) << scale;
  }
}

}  // namespace
}  // namespace kiloband::stats::moment_comparison_test
