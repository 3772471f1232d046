// Power: the biases that each scale is there for, 64x64 pixels, 32 replicates, alpha = 1e-4 for the whole.
// A bias counts as found if it is found with all of kSeeds seeds. Rates: validation/stats/study_comparison.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "stats/comparison/comparison.hpp"
#include "stats/detectable.hpp"
#include "tests/support/simulated_image.hpp"

namespace kiloband::stats::power_test {
namespace {

using test::BatchPool;
using test::SimulatedImage;

constexpr int kSeeds = 3;
using Factor = std::function<double(uint32_t, uint32_t, std::size_t)>;

/// How many of kSeeds comparisons each test fails; "any": the comparison.
std::map<std::string, int> found(const BatchPool& pool, const Factor& mean, const Factor& spread) {
  std::map<std::string, int> count;
  for (uint64_t i = 0; i < kSeeds; ++i) {
    const SimulatedImage shape{64, 64, 32, 2};
    SimulatedImage other = shape;
    other.mean = mean;
    other.spread = spread;
    const Comparison c = compare_independent(simulate(shape, pool, 2 * i), simulate(other, pool, 2 * i + 1),
                                             {.alpha = 1e-4, .seed = i});
    count["any"] += !c.passed;
    for (const TestVerdict& test : c.tests) count[test.name] += !test.passed;
  }
  return count;
}

/// `factor` on one pixel of `every`, scattered.
Factor scattered(double factor, uint32_t every) {
  return [=](uint32_t x, uint32_t y, std::size_t) {
    return (y * 64 + x) * 2654435761u % every == 0 ? factor : 1.0;
  };
}

TEST(Power, OnePercentEverywhere) {
  for (const uint32_t samples : {8u, 64u})
    EXPECT_EQ(found(BatchPool("exponential", samples), scattered(1.01, 1), {})["mean/image"], kSeeds)
        << samples;
}

/// 4096 samples per pixel: 7.6 standard errors.
TEST(Power, TwoPerMilleEverywhere) {
  EXPECT_EQ(found(BatchPool("exponential", 128), scattered(1.002, 1), {})["mean/image"], kSeeds);
}

TEST(Power, TenPercentOfOnePercentOfThePixels) {
  auto few = found(BatchPool("exponential", 64), scattered(1.1, 100), {});
  EXPECT_GE(few["any"], 1) << "2048 samples per pixel";
  EXPECT_EQ(found(BatchPool("exponential", 256), scattered(1.1, 100), {})["mean/pixel"], kSeeds);
}

TEST(Power, HalfAsMuchAgainOfTwoPerMilleOfThePixels) {
  auto count = found(BatchPool("exponential", 12), scattered(1.5, 500), {});
  EXPECT_EQ(count["mean/pixel"], kSeeds);
  EXPECT_EQ(count["mean/image"], 0) << "only pixels can see it";
}

TEST(Power, ATile) {
  const Factor tile = [](uint32_t x, uint32_t y, std::size_t) {
    return x / 8 == 3 && y / 8 == 5 ? 1.06 : 1.0;
  };
  auto count = found(BatchPool("exponential", 64), tile, {});
  EXPECT_EQ(count["mean/tile"], kSeeds);
  EXPECT_EQ(count["mean/image"], 0);
}

/// Variance ratio 1.05 with unchanged mean, light and heavy tails.
TEST(Power, VarianceRatioOfFivePercent) {
  const Factor spread = [](uint32_t, uint32_t, std::size_t) { return std::sqrt(1.05); };
  for (const char* distribution : {"normal", "exponential", "lognormal", "firefly"}) {
    auto count = found(BatchPool(distribution, 16), {}, spread);
    EXPECT_EQ(count["scatter/image"], kSeeds) << distribution;
    EXPECT_EQ(count["mean/image"], 0) << distribution;
  }
}

/// One pixel scatters ten times as much as it should.
TEST(Power, VarianceOfOnePixel) {
  const Factor spread = [](uint32_t x, uint32_t y, std::size_t) { return x == 20 && y == 30 ? 10.0 : 1.0; };
  EXPECT_EQ(found(BatchPool("normal", 8), {}, spread)["variance/pixel"], kSeeds);
}

/// The minimum detectable bias is found in 90 % of the comparisons (binomial, two-sided 1e-3: 30 to 40 of
/// 40), half of it in less than half.
TEST(Power, TheDetectableBiasIsDetected) {
  const BatchPool pool("normal", 8);
  const SimulatedImage shape{32, 32, 32, 1, 1};
  const auto run = [&](double factor, uint64_t seed) {
    SimulatedImage other = shape;
    other.mean = [=](uint32_t, uint32_t, std::size_t) { return factor; };
    return compare_independent(simulate(shape, pool, 2 * seed), simulate(other, pool, 2 * seed + 1),
                               {.alpha = 1e-3});
  };
  double bias = 0;
  for (uint64_t seed = 100; seed < 110; ++seed) bias += run(1, seed).tests[2].detectable.typical / 10;
  int full = 0, half = 0;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    full += !run(1 + bias, seed).tests[2].passed;
    half += !run(1 + bias / 2, seed).tests[2].passed;
  }
  EXPECT_GE(full, 30);
  EXPECT_LE(half, 12);
}

/// One channel is noisy in A's 8 replicates, the other, a little more, in B's 32. The stated worst bias, in
/// the first channel of one pixel, is found in 90 % of the comparisons (binomial, two-sided 1e-3: 30 to 40 of
/// 40). That of the second, whose error is larger, is found there in 15.
TEST(Power, TheWorstDetectableBiasIsDetected) {
  const BatchPool pool("normal", 1);
  const auto side = [&](uint32_t replicates, double first, double second, double bias, uint64_t seed) {
    SimulatedImage shape{16, 16, replicates, 2, 0};
    shape.spread = [=](uint32_t, uint32_t, std::size_t c) { return c == 0 ? first : second; };
    ReplicateImage image = simulate(shape, pool, seed);
    constexpr std::size_t kPixel = 37;
    for (uint32_t r = 0; r < replicates; ++r)
      image.means[(r * image.pixels() + kPixel) * 2] += static_cast<float>(bias);
    return image;
  };
  const auto run = [&](double bias, uint64_t seed) {
    return compare_independent(side(8, 0.03, 1e-4, bias, 2 * seed), side(32, 1e-4, 0.09, 0, 2 * seed + 1),
                               {.variances = false})
        .tests[0];
  };
  const Detectable stated = run(0, 100).detectable;
  EXPECT_EQ(stated.largest_channel, 0u);
  int found = 0;
  for (uint64_t seed = 0; seed < 40; ++seed) found += !run(stated.largest, seed).passed;
  EXPECT_GE(found, 30);
}

/// What few replicates are there for: a bias of a tile, of the image, of all that does not vary.
TEST(Power, FewReplicatesSeeTilesAndTheImage) {
  const BatchPool pool("normal", 64);
  const auto tests = [&](uint32_t a, uint32_t b, double bias, uint32_t edge, double noise, bool fine) {
    SimulatedImage one{32, 32, a, 2}, other{32, 32, b, 2};
    one.spread = other.spread = [=](uint32_t, uint32_t, std::size_t) { return noise; };
    other.mean = [=](uint32_t x, uint32_t y, std::size_t) { return x < edge && y < edge ? 1 + bias : 1.0; };
    std::string failed;
    for (const TestVerdict& test : compare_independent(simulate(one, pool, 1), simulate(other, pool, 2),
                                                       {.variances = false, .fine_scales = fine})
                                       .tests)
      failed += test.passed ? "" : test.name + " ";
    return failed;
  };
  EXPECT_EQ(tests(4, 4, 0.05, 8, 4e-4, true), "mean/tile mean/image ");
  EXPECT_EQ(tests(4, 32, 0.05, 32, 0.1, true), "mean/tile mean/image ");
  EXPECT_EQ(tests(2, 32, 0.5, 32, 2e-3, true), "mean/tile mean/image ");
  for (const uint32_t few : {2u, 4u}) {
    EXPECT_EQ(tests(few, few, 1e-3, 8, 0, true), "mean/tile ") << "the image differs in few pixels";
    EXPECT_EQ(tests(few, few, 1e-3, 32, 0, true), "mean/tile mean/image ");
    EXPECT_EQ(tests(few, few, 1e-3, 32, 0, false), "mean/image ");
    EXPECT_EQ(tests(few, few, 1e-3, 2, 0, true), "") << "four pixels may agree by chance";
    EXPECT_EQ(tests(few, few, 1e-3, 0, 0, true), "");
  }
  EXPECT_EQ(tests(16, 16, 1e-3, 1, 0, true), "mean/pixel mean/tile ") << "below the image's rounding";
}

/// A side without noise leaves the law of the other, however few replicates it has: the quantile of its own
/// law is so far out that the probability there is 0 in double.
TEST(Power, ASideWithoutNoiseLeavesTheOtherSidesLaw) {
  const float inf = std::numeric_limits<float>::infinity();
  const auto detectable = [](RelativeError e) {
    DetectableBias bias;
    bias.add(e, e);
    return bias.at(1e-3, 30).typical;
  };
  const double expected = detectable({.error = 0.1f, .slack = 1e-5f, .dof = inf});
  EXPECT_NEAR(expected, 0.543, 1e-3);
  for (const float dof : {1.f, 2.f, 3.f, 4.f, 100.f}) {
    EXPECT_NEAR(detectable({0.1f, 1e-5f, inf, 0, 0, dof, inf}), expected, 1e-6) << dof;
    EXPECT_NEAR(detectable({0.1f, 1e-5f, inf, 0, 1, inf, dof}), expected, 1e-6) << dof;
  }
}

}  // namespace
}  // namespace kiloband::stats::power_test
