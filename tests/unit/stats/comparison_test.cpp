// What a comparison does with units that are not the usual ones, and what it says.
#include "stats/comparison/comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/simulated_image.hpp"
#include "tests/unit/stats/support.hpp"

namespace kiloband::stats::comparison_test {
namespace {

using test::BatchPool;
using test::SimulatedImage;

const BatchPool& pool() {
  static const BatchPool kPool("exponential", 8);
  return kPool;
}

ReplicateImage image_of(uint64_t seed, SimulatedImage shape = {32, 24, 32, 3}) {
  return simulate(shape, pool(), seed);
}

const TestVerdict& test_named(const Comparison& c, const std::string& name) {
  const auto found = std::ranges::find(c.tests, name, &TestVerdict::name);
  if (found == c.tests.end()) throw std::logic_error("no test " + name);
  return *found;
}

TEST(Comparison, ListsItsTestsAndSharesAlpha) {
  const Comparison c = compare_independent(image_of(1), image_of(2), {.alpha = 0.06});
  EXPECT_EQ(names_of(c), (std::vector<std::string>{"mean/pixel", "mean/tile", "mean/image", "variance/pixel",
                                                   "variance/tile", "scatter/image", "variance/image"}));
  for (const TestVerdict& test : c.tests) EXPECT_DOUBLE_EQ(test.level, 0.06 / 7);
  EXPECT_TRUE(c.passed);
  EXPECT_TRUE(c.notes.empty());
  EXPECT_EQ(c.means[0].units, 32u * 24);
  EXPECT_EQ(c.means[1].units, 4u * 3);
  EXPECT_EQ(c.means[2].units, 1u);
  EXPECT_EQ(c.means[0].t_map.size(), 32u * 24);
}

TEST(Comparison, OneWrongPixelIsFound) {
  SimulatedImage wrong{32, 24, 32, 3};
  wrong.mean = [](uint32_t x, uint32_t y, std::size_t c) { return x == 7 && y == 13 && c == 2 ? 2.0 : 1.0; };
  const Comparison c = compare_independent(image_of(1), image_of(2, wrong), {.alpha = 1e-4});
  EXPECT_FALSE(c.passed);
  EXPECT_EQ(c.decisive().name, "mean/pixel");
  ASSERT_TRUE(c.decisive().worst);
  const WorstUnit& worst = *c.decisive().worst;
  EXPECT_EQ(worst.place.x, 7u);
  EXPECT_EQ(worst.place.y, 13u);
  EXPECT_EQ(worst.channel, 2u);
  EXPECT_LT(worst.difference, -1);
}

/// Deterministic pixels: equal ones count as constant, one that differs fails whatever the rest does.
TEST(Comparison, ConstantPixelsMustBeEqual) {
  ReplicateImage a = image_of(1), b = image_of(2);
  for (ReplicateImage* image : {&a, &b}) {
    for (uint32_t r = 0; r < 32; ++r) {
      for (std::size_t i = 0; i < 6; ++i) image->means[r * image->pixels() * 3 + i] = 0.25f;
    }
  }
  const Comparison same = compare_independent(a, b, {});
  EXPECT_TRUE(same.passed);
  EXPECT_EQ(same.means[0].entries.constant, 6u);
  for (uint32_t r = 0; r < 32; ++r) b.means[r * b.pixels() * 3 + 1] = 0.2501f;
  const Comparison other = compare_independent(a, b, {});
  EXPECT_EQ(other.decisive().name, "mean/pixel");
  EXPECT_EQ(other.decisive().p, 0);
  EXPECT_EQ(other.decisive().worst->channel, 1u);
}

/// Pixels with a contribution now and then are pooled per tile, and the bias of all
/// of them together is found.
TEST(Comparison, ThinPixelsArePooled) {
  const auto sparse = [](uint64_t seed, double factor) {
    ReplicateImage image = image_of(seed, {32, 32, 32, 1});
    Random random(seed);
    for (uint32_t r = 0; r < 32; ++r) {
      for (std::size_t p = 0; p < image.pixels(); ++p) {
        float& value = image.means[r * image.pixels() + p];
        value = random.uniform() < 0.15 ? static_cast<float>(factor) * value : 0;
      }
    }
    return image;
  };
  const Comparison same = compare_independent(sparse(1, 1), sparse(2, 1), {});
  EXPECT_TRUE(same.passed);
  EXPECT_EQ(same.means[0].entries.thin, 32u * 32);
  EXPECT_EQ(same.means[0].pooled_units, 16u);
  EXPECT_EQ(same.means[0].units, 16u);
  ASSERT_FALSE(same.notes.empty());
  EXPECT_EQ(same.notes[0], "pixels: 1024 of 1024 values have too few contributions and were pooled");
  const Comparison other = compare_independent(sparse(1, 1), sparse(2, 2), {});
  EXPECT_LT(test_named(other, "mean/pixel").p, 1e-6);
  EXPECT_TRUE(other.means[0].worst.place.pooled);
}

/// A light that one side never samples: zero against something, pixel by pixel.
TEST(Comparison, AllZeroAgainstLightFails) {
  ReplicateImage a = image_of(1), b = image_of(2);
  std::ranges::fill(b.means, 0.0f);
  const Comparison c = compare_independent(a, b, {.alpha = 1e-4});
  EXPECT_FALSE(test_named(c, "mean/pixel").passed);
  EXPECT_FALSE(test_named(c, "mean/image").passed);
  EXPECT_TRUE(compare_independent(b, b, {}).passed) << "two black images";
}

/// A channel without noise is equal or not; the image's others are tested all the same.
TEST(Comparison, AChannelWithoutNoise) {
  const auto changed = [](uint64_t seed, float first, float factor) {
    ReplicateImage image = image_of(seed);
    for (std::size_t i = 0; i < image.means.size(); ++i)
      image.means[i] = i % 3 == 0 ? first : factor * image.means[i];
    return image;
  };
  const Comparison same = compare_independent(changed(1, 0, 1), changed(2, 0, 1), {});
  EXPECT_TRUE(same.passed);
  const TestVerdict& image = test_named(same, "mean/image");
  EXPECT_GT(image.p, 0);
  EXPECT_LT(image.p, 1);
  EXPECT_GT(image.detectable.typical, 0);
  EXPECT_GE(image.detectable.largest, image.detectable.typical);
  EXPECT_LT(image.detectable.largest, 0.1);
  EXPECT_FALSE(
      test_named(compare_independent(changed(1, 0, 1), changed(2, 0, 1.5), {}), "mean/image").passed);
  EXPECT_EQ(test_named(compare_independent(changed(1, 0.001f, 1), changed(2, 0, 1), {}), "mean/image").p, 0);
}

TEST(Comparison, NotFiniteFails) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    ReplicateImage a = image_of(1);
    a.means[77] = value;
    for (const Comparison& c :
         {compare_independent(a, image_of(2), {}), compare_independent(image_of(2), a, {})}) {
      EXPECT_FALSE(c.passed);
      EXPECT_EQ(c.decisive().name, "finite");
      EXPECT_EQ(c.notes.back(), "1 replicate means of pixels are not finite");
    }
  }
}

TEST(Comparison, ReplicatesWithoutSamplesAreLeftOut) {
  ReplicateImage a = image_of(1);
  for (uint32_t r = 0; r < 32; ++r) {
    if (r > 0) a.samples[r * a.pixels() + 5] = 0;
    if (r % 2 == 1) a.samples[r * a.pixels() + 6] = 0;
    a.means[(r * a.pixels() + 5) * 3] = 1e9f;
  }
  a.means[5 * 3] = 1;
  const Comparison c = compare_independent(a, image_of(2), {});
  EXPECT_TRUE(c.passed);
  EXPECT_EQ(c.means[0].entries.unsampled, 3u);
  EXPECT_EQ(c.means[0].entries.tested, (32u * 24 - 1) * 3);
}

/// Equal seeds: the noise is common, a bias of 1e-4 stands out; unpaired it is lost.
TEST(Comparison, PairsSeeBelowTheNoise) {
  const ReplicateImage a = image_of(1);
  ReplicateImage b = a;
  for (std::size_t i = 0; i < b.means.size(); ++i) b.means[i] *= 1.0001f;
  EXPECT_FALSE(compare_paired(a, b, {.alpha = 1e-4}).passed);
  EXPECT_TRUE(compare_independent(a, b, {.alpha = 1e-4}).passed);
  for (std::size_t i = 0; i < b.means.size(); ++i) b.means[i] = a.means[i] * (i % 2 == 0 ? 1.000001f : 1);
  const Comparison rounding = compare_paired(a, b, {.alpha = 1e-4});
  EXPECT_TRUE(rounding.passed);
  EXPECT_EQ(rounding.notes, std::vector<std::string>{"variances were not compared: the sides are paired"});
}

TEST(Comparison, TruthPerChannelAndPerPixel) {
  SimulatedImage shape{32, 24, 32, 3};
  shape.mean = [](uint32_t x, uint32_t, std::size_t) { return 1 + x / 31.0; };
  const ReplicateImage a = image_of(1, shape);
  Truth truth{{}, {}, true};
  for (uint32_t p = 0; p < 32 * 24; ++p) {
    for (std::size_t c = 0; c < 3; ++c)
      truth.value.push_back((1 + p % 32 / 31.0) * (1 + 0.5 * static_cast<double>(c)));
  }
  const Comparison right = compare_truth(a, truth, {.alpha = 1e-3});
  EXPECT_TRUE(right.passed) << right.decisive().name << " " << right.decisive().p;
  for (double& value : truth.value) value *= 1.02;
  EXPECT_FALSE(compare_truth(a, truth, {.alpha = 1e-3}).passed);
  for (const double value : truth.value) truth.bound.push_back(0.02 * value);
  EXPECT_TRUE(compare_truth(a, truth, {.alpha = 1e-3}).passed) << "the truth says that it may be off by 2 %";
  EXPECT_FALSE(compare_truth(a, {{1, 1.5, 2}, {}, false}, {.alpha = 1e-3}).passed);
}

/// Lognormal noise: with 8 samples a replicate pixels mostly lie below their mean.
TEST(Comparison, SkewedNoiseIsNotHeldAgainstATruthPixelByPixel) {
  const BatchPool skewed("lognormal", 8);
  const Comparison c = compare_truth(simulate({32, 32, 32, 2}, skewed, 1), {{1, 1.5}, {}, false}, {});
  const std::vector<std::string> names = names_of(c);
  EXPECT_EQ(std::ranges::count(names, "mean/pixel"), 0);
  EXPECT_EQ(names.back(), "mean/image");
  EXPECT_TRUE(c.passed);
  EXPECT_EQ(
      c.notes.back(),
      "pixels were not held against the truth: the noise is too skewed, or too unlike from one to another");
}

/// One estimator has met no bright path in a pixel: nothing in its error says so. It is a difference, but one
/// that different estimators are told about.
TEST(Comparison, DifferentEstimatorsAreToldOfPathsThatOneHasNotMet) {
  const BatchPool skewed("lognormal", 8), smooth("exponential", 64);
  const SimulatedImage shape{32, 32, 32, 2};
  const ReplicateImage a = simulate(shape, skewed, 1);
  ReplicateImage b = simulate(shape, skewed, 2);
  const ReplicateImage dim = simulate(shape, smooth, 3);
  constexpr std::size_t kPixel = 5 * 32 + 9;
  for (uint32_t r = 0; r < b.replicates; ++r) {
    const std::size_t value = (r * b.pixels() + kPixel) * b.channels;
    for (std::size_t c = 0; c < b.channels; ++c) b.means[value + c] = 0.2f * dim.means[value + c];
  }
  const auto says_so = [](const Comparison& c) {
    return std::ranges::any_of(c.notes, [](const std::string& note) {
      return note.starts_with("pixels or tiles differ, the image does not");
    });
  };
  const Comparison same = compare_independent(a, b, {}),
                   different = compare_independent(a, b, {.variances = false}),
                   image = compare_independent(a, b, {.variances = false, .fine_scales = false});
  EXPECT_FALSE(same.passed || different.passed);
  EXPECT_EQ(different.decisive().worst->place.x, 9u);
  EXPECT_EQ(different.decisive().worst->place.y, 5u);
  EXPECT_FALSE(says_so(same)) << "one estimator has one law: no excuse";
  EXPECT_TRUE(says_so(different));
  EXPECT_TRUE(image.passed);
  EXPECT_EQ(names_of(image), std::vector<std::string>{"mean/image"});
  ReplicateImage wrong = b;
  for (float& mean : wrong.means) mean *= 2;
  EXPECT_FALSE(says_so(compare_independent(a, wrong, {.variances = false}))) << "the image differs too";
}

TEST(Comparison, StripsAreTheWhole) {
  const SimulatedImage shape{20, 21, 8, 2};
  const ReplicateImage a = image_of(1, shape), b = image_of(2, shape);
  const auto strip = [](const ReplicateImage& image, uint32_t y0, uint32_t rows) {
    ReplicateImage part{image.width, rows, image.channels, image.replicates, {}, {}};
    for (uint32_t r = 0; r < image.replicates; ++r) {
      const std::size_t first = r * image.pixels() + y0 * image.width, count = rows * image.width;
      part.samples.insert(part.samples.end(), &image.samples[first], &image.samples[first] + count);
      part.means.insert(part.means.end(), &image.means[first * 2], &image.means[first * 2] + count * 2);
    }
    return part;
  };
  StripComparison strips(Kind::kIndependent, 20, 21, 2, 8, 8, {});
  strips.add(strip(a, 0, 16), strip(b, 0, 16));
  strips.add(strip(a, 16, 5), strip(b, 16, 5));
  const Comparison parts = strips.finish(), whole = compare_independent(a, b, {});
  ASSERT_EQ(parts.tests.size(), whole.tests.size());
  for (std::size_t i = 0; i < whole.tests.size(); ++i) EXPECT_EQ(parts.tests[i].p, whole.tests[i].p);
  EXPECT_EQ(parts.image_a, whole.image_a);
  EXPECT_EQ(whole.notes, std::vector<std::string>{
                             "8 replicates on a side: 32 or more are wanted; the tests hold but see less"});
}

/// Eight for every kind; those of tiles and the image are there.
TEST(Comparison, PixelsNeedEightReplicates) {
  const SimulatedImage few{32, 24, 7, 3}, many{32, 24, 8, 3};
  const ReplicateImage a = image_of(1, few), b = image_of(2, many);
  const std::string note = "mean/pixel: not tested, 8 replicates on every side are needed";
  const Truth truth{{1, 1.5, 2}, {}, false};
  for (const Comparison& c :
       {compare_independent(a, b, {.variances = false}), compare_independent(b, a, {.variances = false}),
        compare_paired(a, image_of(2, few), {}), compare_truth(a, truth, {})}) {
    EXPECT_EQ(names_of(c), (std::vector<std::string>{"mean/tile", "mean/image"}));
    EXPECT_TRUE(c.passed);
    EXPECT_EQ(std::ranges::count(c.notes, note), 1);
  }
  for (const Comparison& c : {compare_independent(b, image_of(3, many), {}), compare_truth(b, truth, {})}) {
    EXPECT_EQ(c.tests[0].name, "mean/pixel");
    EXPECT_EQ(std::ranges::count(c.notes, note), 0);
  }
  const Comparison image = compare_independent(a, b, {.variances = false, .fine_scales = false});
  EXPECT_EQ(std::ranges::count(image.notes, note), 0) << "not asked for";
}

TEST(Comparison, WrongShapesAreOurBug) {
  EXPECT_THROW(compare_independent(image_of(1), image_of(2, {32, 32, 32, 3}), {}), std::logic_error);
  EXPECT_THROW(compare_truth(image_of(1), {{1, 2}, {}, false}, {}), std::logic_error);
  StripComparison strips(Kind::kIndependent, 32, 24, 3, 32, 32, {});
  EXPECT_THROW(strips.finish(), std::logic_error);
}

}  // namespace
}  // namespace kiloband::stats::comparison_test
