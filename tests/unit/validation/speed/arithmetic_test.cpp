// Numbers from repetitions, against values computed by hand.
#include "validation/speed/arithmetic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kiloband::speed {
namespace {

TEST(SpeedArithmetic, MedianAndHalfRange) {
  const Estimate odd = median_of({5, 1, 2}), even = median_of({4, 1, 2, 9}), one = median_of({7});
  EXPECT_DOUBLE_EQ(odd.value, 2);
  EXPECT_DOUBLE_EQ(odd.error, 2);
  EXPECT_DOUBLE_EQ(even.value, 3);
  EXPECT_DOUBLE_EQ(even.error, 4);
  EXPECT_DOUBLE_EQ(one.value, 7);
  EXPECT_TRUE(std::isnan(one.error));
  EXPECT_TRUE(std::isnan(median_of({}).value));
}

TEST(SpeedArithmetic, MeanAndStandardError) {
  const Estimate mean = mean_of({1, 2, 3, 6});  // s^2 = 14/3, s^2/4 = 7/6
  EXPECT_DOUBLE_EQ(mean.value, 3);
  EXPECT_DOUBLE_EQ(mean.error, std::sqrt(7.0 / 6));
  EXPECT_TRUE(std::isnan(mean_of({3}).error));
  EXPECT_TRUE(std::isnan(mean_of({}).value));
}

TEST(SpeedArithmetic, TheReferencesPartIsTakenAway) {
  const Estimate left = without_reference({5, 7}, {2, 0.6});  // mean 6 +- 1
  EXPECT_DOUBLE_EQ(left.value, 4);
  EXPECT_DOUBLE_EQ(left.error, std::hypot(1.0, 0.6));
  EXPECT_LT(without_reference({1, 1}, {2, 0}).value, 0) << "not clamped: the mean would have a bias";
}

TEST(SpeedArithmetic, RootsAndEfficiency) {
  const Estimate root = root_of({4, 0.8});
  EXPECT_DOUBLE_EQ(root.value, 2);
  EXPECT_DOUBLE_EQ(root.error, 0.2);
  EXPECT_TRUE(std::isnan(root_of({-1, 0.1}).value));
  const Estimate efficiency = efficiency_of({0.01, 0.001}, {2, 0.2});  // 10 % each
  EXPECT_DOUBLE_EQ(efficiency.value, 50);
  EXPECT_NEAR(efficiency.error, 50 * std::hypot(0.1, 0.1), 1e-12);
  EXPECT_TRUE(std::isnan(efficiency_of({0, 1}, {1, 0}).value));
  EXPECT_TRUE(std::isnan(efficiency_of({1, 1}, {0, 0}).value));
  const Estimate ratio = ratio_of({6, 0.6}, {3, 0.3});
  EXPECT_DOUBLE_EQ(ratio.value, 2);
  EXPECT_NEAR(ratio.error, 2 * std::hypot(0.1, 0.1), 1e-12);
}

/// The stated error of an efficiency is the spread of efficiencies of independent runs: normal numbers of known variance
/// against a reference of 1/4 of it. 4000 runs: the ratio is known to 1.6 % (one sigma, with kurtosis), 8 % are five.
TEST(SpeedArithmetic, TheErrorOfAnEfficiencyIsItsSpread) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  double stated = 0;
  constexpr int kRuns = 4000, kRepetitions = 12, kUnits = 64;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> squares;
    for (int i = 0; i < kRepetitions; ++i) {
      double sum = 0;
      for (int u = 0; u < kUnits; ++u) {
        const double d = normal(random) + 0.5 * normal(random);
        sum += d * d / kUnits;
      }
      squares.push_back(sum);
    }
    const Estimate e = efficiency_of(without_reference(squares, {0.25, 0}), {2, 0});
    values.push_back(e.value);
    stated += e.error / kRuns;
  }
  const Estimate mean = mean_of(values);
  EXPECT_NEAR(mean.value, 0.5, 0.01);
  EXPECT_NEAR(stated / (mean.error * std::sqrt(double{kRuns})), 1, 0.08);
}

}  // namespace
}  // namespace kiloband::speed
