// Tests of variances by hand; their rates and power are in rates_test.cpp and power_test.cpp.
#include "stats/variance_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stats/comparison/comparison_verdict.hpp"
#include "tests/support/simulated_image.hpp"
#include "tests/unit/stats/support.hpp"

namespace kiloband::stats::variance_test {
namespace {

UnitSample one_channel(std::vector<double> values) {
  const std::size_t count = values.size();
  return {1, std::move(values), std::vector<double>(count, 1.0)};
}

TEST(Variances, DeviationsFromTheMedian) {
  EXPECT_EQ(deviations_from_median(one_channel({1, 5, 2, 10})).means,
            (std::vector<double>{2.5, 1.5, 1.5, 6.5}));
  EXPECT_EQ(deviations_from_median(one_channel({1, 5, 2})).means, (std::vector<double>{1, 3, 0}));
  UnitSample uneven = one_channel({1, 5, 2});
  uneven.weights = {8, 2, 2};
  EXPECT_NEAR(deviations_from_median(uneven).means[0], std::sqrt(2), 1e-15);
}

/// Median 3: squares 4, 1, 1, 4 against 25, 4, 4, 25; the sides' means 2.5 and 14.5.
TEST(Variances, PooledByHand) {
  PooledVarianceTest test(1, 4, 4);
  test.add(one_channel({1, 2, 4, 5}), one_channel({-2, 1, 5, 8}), {}, 0);
  const PooledVariance variance = test.variance(1);
  EXPECT_NEAR(variance.ratio, 2.5 / 14.5, 1e-12);
  EXPECT_EQ(variance.channel, 0u);
  EXPECT_EQ(variance.entries, 1u);
  EXPECT_NEAR(variance.t, (2.5 - 14.5) / std::sqrt((9.0 + 441.0) / 12), 1e-6);
  EXPECT_NEAR(test.scatter(1).ratio, std::pow(1.5 / 3.5, 2), 1e-12) << "the median d is 2: nothing is cut";
}

TEST(Variances, RoundingIsNoScatter) {
  PooledVarianceTest test(1, 4, 4);
  test.add(one_channel({1, 1 + 1e-7, 1, 1 - 1e-7}), one_channel({1, 1, 1, 1 + 1e-6}), {}, 1e-5);
  EXPECT_EQ(test.variance(1).entries, 0u);
  EXPECT_EQ(test.variance(1).skipped, 1u);
  EXPECT_EQ(test.variance(1).p, 1);
}

/// The estimate of a ratio of 1.5 within 4.5 of its standard errors; the error is what 4096 pixels promise:
/// Var ln s^2 = 2 / 31 per pixel and side for normal noise.
TEST(Variances, TheRatioIsEstimated) {
  const test::BatchPool pool("normal", 4);
  test::SimulatedImage shape{64, 64, 32, 1};
  const ReplicateImage b = simulate(shape, pool, 1);
  shape.spread = [](uint32_t, uint32_t, std::size_t) { return std::sqrt(1.5); };
  const Comparison c = compare_independent(simulate(shape, pool, 2), b, {});
  EXPECT_NEAR(std::log(c.pooled_variance->ratio_all), std::log(1.5), 4.5 * c.pooled_variance->log_error_all);
  EXPECT_NEAR(c.pooled_variance->log_error_all, std::sqrt(2 * 2.0 / 31 / 4096), 0.0015);
  EXPECT_NEAR(c.pooled_scatter->ratio_all, std::pow(1.5, 0.9), 0.04) << "cut deviations";
  EXPECT_EQ(c.pooled_variance->entries, 4096u);
}

/// Replicates of 4 and of 5 samples scatter differently without a difference: 130 samples in 32 replicates of
/// either side do not, and 160 against 128 do.
TEST(Variances, AreOfEqualNumbersOfSamples) {
  const auto dealt = [](double samples) {
    UnitSample sample = one_channel(std::vector<double>(32, 1.0));
    for (std::size_t r = 0; r < 32; ++r)
      sample.weights[r] = std::floor(samples / 32) + (static_cast<double>(r) < std::fmod(samples, 32));
    return sample;
  };
  EXPECT_TRUE(replicates_have_same_sizes(dealt(130), dealt(130)));
  EXPECT_TRUE(replicates_have_same_sizes(dealt(4000), dealt(4004)));
  EXPECT_FALSE(replicates_have_same_sizes(dealt(128), dealt(160)));
  EXPECT_FALSE(replicates_have_same_sizes(dealt(32), dealt(64)));
  EXPECT_FALSE(replicates_have_same_sizes(dealt(4000), dealt(4006)));
  UnitSample uneven = dealt(128);
  uneven.weights[3] = 6;
  EXPECT_FALSE(replicates_have_same_sizes(uneven, uneven));
}

TEST(Variances, OfUnitsWantEightReplicates) {
  const test::BatchPool pool("normal", 4);
  for (const uint32_t replicates : {2u, 7u, 8u}) {
    const test::SimulatedImage shape{16, 16, replicates, 2};
    const Comparison c = compare_independent(simulate(shape, pool, 1), simulate(shape, pool, 2), {});
    const std::vector<std::string> names = names_of(c);
    EXPECT_EQ(std::ranges::count(names, "variance/pixel"), replicates == 8) << replicates;
    EXPECT_EQ(std::ranges::count(names, "variance/tile"), replicates == 8) << replicates;
    EXPECT_EQ(std::ranges::count(names, "scatter/image"), 1) << replicates;
    EXPECT_EQ(
        std::ranges::count(
            c.notes, "variance/pixel, variance/tile: not tested, 8 replicates on every side are needed"),
        replicates < 8)
        << replicates;
  }
}

}  // namespace
}  // namespace kiloband::stats::variance_test
