// Replicate moments against a two-pass evaluation in double, and the expectation of the variance estimate.
#include "film/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace kiloband {
namespace {

struct Replicate {
  uint64_t n;
  std::vector<float> means;
};

struct Moments {
  double mean = 0, variance = 0, m2 = 0;
};

// The definition in the header, two passes in double.
Moments oracle(const std::vector<Replicate>& replicates, std::size_t channel) {
  Moments result;
  double samples = 0;
  for (const Replicate& r : replicates) {
    samples += static_cast<double>(r.n);
    result.mean += static_cast<double>(r.n) * r.means[channel];
  }
  result.mean /= samples;
  for (const Replicate& r : replicates)
    result.m2 +=
        static_cast<double>(r.n) * (r.means[channel] - result.mean) * (r.means[channel] - result.mean);
  result.variance = result.m2 / (samples * (static_cast<double>(replicates.size()) - 1));
  return result;
}

// R replicates of K channels; channel k has mean 10^(k % 7 - 3) and relative spread between 1 and 1e-3.
std::vector<Replicate> synthetic(std::size_t count, std::size_t channels, uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Replicate> replicates(count);
  for (Replicate& r : replicates) {
    r.n = 1 + generator() % 9;
    for (std::size_t k = 0; k < channels; ++k) {
      const double scale = std::pow(10.0, static_cast<double>(k % 7) - 3);
      r.means.push_back(
          static_cast<float>(scale * (1 + uniform(generator) * std::pow(10.0, -static_cast<double>(k % 4)))));
    }
  }
  return replicates;
}

ReplicateMoments accumulate(const std::vector<Replicate>& replicates, std::size_t first, std::size_t last) {
  ReplicateMoments moments(1, replicates.front().means.size(), true);
  for (std::size_t i = first; i < last; ++i) moments.add(0, replicates[i].n, replicates[i].means);
  return moments;
}

void expect_oracle(const ReplicateMoments& moments, const std::vector<Replicate>& replicates) {
  std::vector<float> variance(moments.channels());
  moments.variance_of_mean(0, variance);
  // At most an ulp for each replicate, in random directions: the square root of their number.
  const double mean_error = 1.2e-7 * (2 + std::sqrt(static_cast<double>(replicates.size())));
  for (std::size_t k = 0; k < moments.channels(); ++k) {
    const Moments expected = oracle(replicates, k);
    EXPECT_NEAR(moments.mean(0)[k], expected.mean, mean_error * std::fabs(expected.mean)) << "channel " << k;
    // d has an absolute error of some 1e-7 of the mean;
    // with spread 1e-3 of it that is 1e-4 of a term of M2, at random.
    const double spread = std::sqrt(expected.variance) / std::fabs(expected.mean);
    EXPECT_NEAR(variance[k], expected.variance, (2e-6 + 4e-7 / spread) * expected.variance)
        << "channel " << k;
  }
}

TEST(ReplicateMoments, MatchesTheDoubleOracleWithUnequalSizes) {
  for (const std::size_t count : {2u, 3u, 16u, 200u}) {
    const auto replicates = synthetic(count, 37, static_cast<uint32_t>(count));
    const ReplicateMoments moments = accumulate(replicates, 0, count);
    expect_oracle(moments, replicates);
    EXPECT_EQ(moments.replicates(0), count);
  }
}

// Each replicate adds a rounding error below an ulp to the mean;
// 10^5 replicates of one sample must stay below 1e-5.
TEST(ReplicateMoments, ManyReplicatesLoseNothingVisible) {
  const std::size_t count = 10'000;
  const auto replicates = synthetic(count, 4, 5);
  const ReplicateMoments moments = accumulate(replicates, 0, count);
  for (std::size_t k = 0; k < 4; ++k) {
    const double expected = oracle(replicates, k).mean;
    EXPECT_NEAR(moments.mean(0)[k], expected, 1e-5 * expected) << "channel " << k;
  }
}

TEST(ReplicateMoments, OneReplicateHasNoErrorBar) {
  ReplicateMoments moments(2, 3, true);
  moments.add(1, 4, std::vector<float>{1, 2, 3});
  moments.add(1, 0, std::vector<float>{9, 9, 9});  // an empty replicate is none
  std::vector<float> variance(3, 0.0f);
  moments.variance_of_mean(1, variance);
  for (const float v : variance) EXPECT_TRUE(std::isnan(v));
  moments.variance_of_mean(0, variance);
  for (const float v : variance) EXPECT_TRUE(std::isnan(v));
  EXPECT_EQ(moments.mean(1)[2], 3.0f);
  EXPECT_EQ(moments.mean(0)[2], 0.0f);
  EXPECT_EQ(moments.replicates(1), 1u);
  EXPECT_EQ(moments.samples(1), 4u);
}

TEST(ReplicateMoments, EqualReplicatesHaveVarianceZero) {
  ReplicateMoments moments(1, 2, true);
  for (int i = 0; i < 5; ++i) moments.add(0, 3, std::vector<float>{0.1f, 1e-30f});
  std::vector<float> variance(2, 1.0f);
  moments.variance_of_mean(0, variance);
  EXPECT_EQ(variance, (std::vector<float>{0.0f, 0.0f}));
  EXPECT_EQ(moments.mean(0)[0], 0.1f);
}

TEST(ReplicateMoments, MeansOnlyAgreeWithMeansAndVariances) {
  const auto replicates = synthetic(16, 21, 8);
  ReplicateMoments plain(1, 21, false);
  for (const Replicate& r : replicates) plain.add(0, r.n, r.means);
  const ReplicateMoments both = accumulate(replicates, 0, 16);
  for (std::size_t k = 0; k < 21; ++k) EXPECT_EQ(plain.mean(0)[k], both.mean(0)[k]);
  std::vector<float> out(21);
  EXPECT_THROW(plain.variance_of_mean(0, out), std::logic_error);
}

TEST(ReplicateMoments, RefusesWrongShapes) {
  ReplicateMoments moments(2, 3, true);
  EXPECT_THROW(moments.add(2, 1, std::vector<float>(3)), std::logic_error);
  EXPECT_THROW(moments.add(0, 1, std::vector<float>(2)), std::logic_error);
  EXPECT_THROW(moments.mean(2), std::logic_error);
  EXPECT_THROW(ReplicateMoments(std::numeric_limits<std::size_t>::max() / 2, 3, true), std::length_error);
}

// E[V] = Var(mean) = sigma^2 / N for replicate means with variance sigma^2 / n_r:
//   E[sum n_r (m_r - m)^2] = sum n_r sigma^2/n_r - N sigma^2/N = (R - 1) sigma^2.
// Checked with 16 replicates, sizes 1 to 9 mixed in each trial, of Gaussian means. V N/sigma^2 has variance
// 2/15, so the mean of T = 40000 trials has a standard error of 0.0018. z test: a correct estimator fails for
// one seed in 1e6 (|z| > 4.9); a bias of 1.2 % would be caught with probability 0.95. Forgetting the weights
// or dividing by R instead of R - 1 (6 %) fails.
TEST(ReplicateMoments, VarianceEstimateIsUnbiased) {
  constexpr std::size_t kTrials = 40'000, kReplicates = 16;
  constexpr double kSigma = 3;
  std::mt19937_64 generator(2024);
  std::normal_distribution<double> normal;
  ReplicateMoments moments(1, kTrials, true);
  uint64_t samples = 0;
  for (std::size_t r = 0; r < kReplicates; ++r) {
    const uint64_t n = 1 + (r * 5) % 9;
    samples += n;
    std::vector<float> means(kTrials);
    for (float& m : means)
      m = static_cast<float>(1 + kSigma / std::sqrt(static_cast<double>(n)) * normal(generator));
    moments.add(0, n, means);
  }
  std::vector<float> variance(kTrials);
  moments.variance_of_mean(0, variance);
  double sum = 0;
  for (const float v : variance) sum += v * static_cast<double>(samples) / (kSigma * kSigma);
  const double z = (sum / kTrials - 1) / std::sqrt(2.0 / (kReplicates - 1) / kTrials);
  EXPECT_LT(std::fabs(z), 4.9) << "mean of V N / sigma^2 is " << sum / kTrials;
}

TEST(ReplicatePlan, SizesDifferByAtMostOneAndAddUp) {
  for (uint64_t samples = 0; samples < 200; ++samples) {
    for (const uint32_t wanted : {1u, 2u, 3u, 16u, 64u}) {
      const ReplicatePlan plan = ReplicatePlan::deal(samples, wanted);
      ASSERT_GE(plan.replicates, 1u);
      ASSERT_LE(plan.replicates, wanted);
      uint64_t sum = 0, least = samples + 1, most = 0;
      for (uint32_t r = 0; r < plan.replicates; ++r) {
        sum += plan.size(r);
        least = std::min(least, plan.size(r));
        most = std::max(most, plan.size(r));
      }
      EXPECT_EQ(sum, samples);
      EXPECT_LE(most - least, 1u);
      if (plan.replicates > 1) {
        EXPECT_GE(least, 2u);
      }
      // R is lowered only where it must be: one more replicate would have fewer than 2 samples somewhere.
      if (plan.replicates < wanted) {
        EXPECT_LT(samples, 2 * (plan.replicates + uint64_t{1}));
      }
    }
  }
}

// Replicate r owns the samples r, r + R, ...: counting them gives size(r).
TEST(ReplicatePlan, SizesMatchTheDealtSamples) {
  const ReplicatePlan plan = ReplicatePlan::deal(53, 16);
  std::vector<uint64_t> dealt(plan.replicates);
  for (uint64_t s = 0; s < plan.samples; ++s) ++dealt[s % plan.replicates];
  for (uint32_t r = 0; r < plan.replicates; ++r) EXPECT_EQ(plan.size(r), dealt[r]);
  EXPECT_THROW(plan.size(16), std::logic_error);
  EXPECT_EQ(ReplicatePlan::deal(1'000'000, 16).replicates, 16u);
  EXPECT_EQ(ReplicatePlan::deal(3, 16).replicates, 1u);
  EXPECT_EQ(ReplicatePlan::deal(4, 0).replicates, 1u);
}

}  // namespace
}  // namespace kiloband
