// Values that are not there or not finite, and tests that saw nothing: neither may pass for agreement.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "stats/comparison/comparison.hpp"
#include "stats/comparison/moment_comparison.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/simulated_image.hpp"
#include "tests/unit/stats/support.hpp"

namespace kiloband::stats::gaps_test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

ReplicateImage image_of(uint64_t seed, test::SimulatedImage shape = {16, 16, 32, 2}) {
  static const test::BatchPool kPool("normal", 8);
  return simulate(shape, kPool, seed);
}

void lose_samples(ReplicateImage& image, std::size_t pixel) {
  for (uint32_t r = 0; r < image.replicates; ++r) {
    image.samples[r * image.pixels() + pixel] = 0;
    for (std::size_t c = 0; c < image.channels; ++c)
      image.means[(r * image.pixels() + pixel) * image.channels + c] = kNaN;
  }
}

bool says(const Comparison& c, const std::string& note) {
  return std::ranges::find(c.notes, note) != c.notes.end();
}

Comparison compare(const MomentImage& a, const MomentImage& b) {
  MomentComparison comparison(a.width, a.height, a.channels, false, {});
  comparison.add(a, b);
  return comparison.finish();
}

TEST(Gaps, ATruthThatIsNotFiniteIsADifferenceWhereThereAreValues) {
  ReplicateImage a = image_of(1);
  Truth truth{{}, {}, true};
  for (std::size_t p = 0; p < a.pixels(); ++p) truth.value.insert(truth.value.end(), {1.0, 1.5});
  truth.value[7 * 2] = truth.value[7 * 2 + 1] = kNaN;
  truth.value[9 * 2 + 1] = kInfinite;
  const Comparison found = compare_truth(a, truth, {});
  EXPECT_EQ(found.decisive().name, "finite");
  EXPECT_EQ(found.non_finite, 2u);
  EXPECT_TRUE(says(found, "2 replicate means or true values of pixels are not finite"));
  EXPECT_TRUE(std::ranges::all_of(found.image_b, [](double v) { return v > 0.9; }));
  lose_samples(a, 7);
  lose_samples(a, 9);
  const Comparison absent = compare_truth(a, truth, {});
  EXPECT_TRUE(absent.passed) << absent.decisive().name;
  EXPECT_EQ(absent.non_finite, 0u);
}

TEST(Gaps, ABoundThatIsNotFiniteIsADifference) {
  EXPECT_EQ(compare_truth(image_of(1), {{1, 1.5}, {0, kNaN}, false}, {}).decisive().name, "finite");
}

TEST(Gaps, NothingFiniteIsADifferenceNothingAtAllIsRefused) {
  ReplicateImage a = image_of(1, {8, 8, 32, 1});
  std::ranges::fill(a.means, kNaN);
  const Comparison c = compare_independent(a, image_of(2, {8, 8, 32, 1}), {});
  EXPECT_EQ(names_of(c), std::vector<std::string>{"finite"});
  EXPECT_FALSE(c.passed);
  ReplicateImage b = a;
  std::ranges::fill(b.samples, 0);
  EXPECT_EQ(test::error_of([&] { compare_independent(b, b, {}); }),
            "no pixel has values and errors on both sides: there is nothing to compare");
}

TEST(Gaps, AnInfiniteVarianceIsNoError) {
  const Comparison c = compare({2, 1, 1, 9, {1, 1}, {kInfinite, 1}}, {2, 1, 1, 9, {1, 1}, {1, 1}});
  EXPECT_TRUE(c.passed);
  EXPECT_EQ(c.means[0].entries.unsampled, 1u);
  EXPECT_EQ(c.means[0].entries.tested, 1u);
  EXPECT_THROW(compare({1, 1, 1, 9, {1}, {kInfinite}}, {1, 1, 1, 9, {1}, {kInfinite}}), InputError);
}

/// The other channels of the pixel are compared: a difference there does not hide behind a variance that is
/// not there.
TEST(Gaps, AVarianceIsMissingInOneChannelAlone) {
  const MomentImage a{2, 1, 2, 9, {1, 1, 1, 1}, {1, 1, 1, 1}};
  const MomentImage b{2, 1, 2, 9, {1, 1, 1000, 1}, {1, 1, 1, kNaN}};
  for (const bool independent : {false, true}) {
    MomentComparison comparison(2, 1, 2, independent, {});
    comparison.add(a, b);
    const Comparison c = comparison.finish();
    EXPECT_FALSE(c.passed);
    EXPECT_EQ(c.means[0].entries.unsampled, 1u);
    EXPECT_EQ(c.means[0].entries.tested, 3u);
    EXPECT_TRUE(says(c, "pixels: 1 values have no error on a side and were not compared"));
    if (independent) {
      EXPECT_EQ(c.image_b[0], 500.5);
      EXPECT_EQ(c.image_b[1], 1) << "of the pixels that have a variance";
    }
  }
}

TEST(Gaps, MomentsLeaveOutPixelsWithoutValuesAlone) {
  const auto pixels = [](float a, float b) { return MomentImage{2, 1, 2, 9, {1, 1, a, b}, {1, 1, 1, 1}}; };
  EXPECT_TRUE(compare(pixels(kNaN, kNaN), pixels(kNaN, kNaN)).passed);
  for (const auto& [a, b] :
       {std::pair{pixels(kInfinite, 1), pixels(1, kNaN)},
        std::pair{pixels(kInfinite, 1), pixels(kInfinite, 1)}, std::pair{pixels(kNaN, 1), pixels(kNaN, kNaN)},
        std::pair{pixels(kNaN, kNaN), pixels(1, 1)}}) {
    const Comparison c = compare(a, b);
    EXPECT_EQ(c.decisive().name, "finite");
    EXPECT_EQ(c.non_finite, 1u);
    EXPECT_TRUE(says(c, "1 pixels have values that are not finite, or values on one side alone"));
  }
}

TEST(Gaps, MomentsOfReplicates) {
  ReplicateImage a{4, 1, 1, 3, {1, 1, 1, 1, 2, kNaN, 2, 2, 3, 3, 3, 3}, {8, 8, 8, 8, 8, 8, 0, 8, 8, 8, 0, 8}};
  lose_samples(a, 3);
  const MomentImage m = moments_of(a);
  EXPECT_EQ(m.mean[0], 2);
  EXPECT_TRUE(std::isinf(m.mean[1])) << "a replicate is not finite";
  EXPECT_EQ(m.mean[2], 1) << "one replicate: a mean without an error";
  EXPECT_TRUE(std::isnan(m.variance[2]));
  EXPECT_TRUE(std::isnan(m.mean[3])) << "no samples";
}

/// Light in every fourth replicate, in all pixels at once: tiles are as thin as pixels,
/// the image alone is left.
TEST(Gaps, ThinEverywhere) {
  const auto sparse = [](uint64_t seed) {
    ReplicateImage image = image_of(seed);
    for (std::size_t i = 0; i < image.means.size(); ++i) {
      if ((i / (image.pixels() * image.channels) + seed) % 4 != 0) image.means[i] = 0;
    }
    return image;
  };
  const Comparison c = compare_independent(sparse(1), sparse(2), {.alpha = 0.01});
  EXPECT_EQ(names_of(c), std::vector<std::string>{"mean/image"});
  EXPECT_EQ(c.tests[0].level, 0.01) << "what saw nothing takes no share";
  EXPECT_GT(c.tests[0].detectable.typical, 0) << "of its own scale";
  EXPECT_TRUE(says(c,
                   "mean/pixel, mean/tile, variance/pixel, variance/tile, scatter/image, variance/image: not "
                   "tested, no value has enough contributions and replicates, or none varies"));
}

/// The pooled tests want all replicates.
TEST(Gaps, AReplicateWithoutSamplesAnywhere) {
  ReplicateImage a = image_of(1);
  std::fill_n(a.samples.end() - static_cast<std::ptrdiff_t>(a.pixels()), a.pixels(), 0);
  const Comparison c = compare_independent(a, image_of(2), {});
  EXPECT_TRUE(c.passed);
  EXPECT_EQ(names_of(c), (std::vector<std::string>{"mean/pixel", "mean/tile", "mean/image", "variance/pixel",
                                                   "variance/tile"}));
  EXPECT_TRUE(says(c,
                   "scatter/image, variance/image: not tested, no value has enough contributions and "
                   "replicates, or none varies"));
}

}  // namespace
}  // namespace kiloband::stats::gaps_test
