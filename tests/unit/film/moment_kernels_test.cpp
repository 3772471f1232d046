// The loops over channels against plain ones, bit by bit, on every instruction set that this machine has.
#include "film/moment_kernels.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/every_target.hpp"

namespace kiloband::film {
namespace {

using test::on_every_target;

struct Arrays {
  std::vector<float> values, mean, m2;
  std::vector<double> sums;
};

Arrays random_arrays(std::size_t channels) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 3);
  Arrays arrays;
  for (std::size_t k = 0; k < channels; ++k) {
    arrays.values.push_back(uniform(random));
    arrays.mean.push_back(uniform(random));
    arrays.m2.push_back(uniform(random));
    arrays.sums.push_back(uniform(random));
  }
  return arrays;
}

// Vectors, groups of four and single channels.
constexpr std::size_t kCounts[] = {1, 3, 4, 8, 15, 16, 31, 64, 103};
constexpr float kFactor = 1.0f / 3;
constexpr MomentWeights kWeights{0.2f, 2.4f};

TEST(MomentKernels, UpdatesHaveTheBitsOfPlainLoops) {
  for (const std::size_t channels : kCounts) {
    const Arrays before = random_arrays(channels);
    Arrays expected = before;
    for (std::size_t k = 0; k < channels; ++k) {
      const float difference = kFactor * before.values[k] - before.mean[k];
      expected.mean[k] += kWeights.mean * difference;
      expected.m2[k] += (kWeights.m2 * difference) * difference;
    }
    on_every_target([&] {
      Arrays both = before, mean = before;
      update_moments({channels, before.values.data(), kFactor}, kWeights, both.mean.data(), both.m2.data());
      update_mean({channels, before.values.data(), kFactor}, kWeights.mean, mean.mean.data());
      EXPECT_EQ(both.mean, expected.mean) << channels;
      EXPECT_EQ(both.m2, expected.m2) << channels;
      EXPECT_EQ(mean.mean, expected.mean) << channels;
    });
  }
}

TEST(MomentKernels, FirstMeansAndSumsHaveTheBitsOfPlainLoops) {
  for (const std::size_t channels : kCounts) {
    const Arrays before = random_arrays(channels);
    Arrays expected = before;
    for (std::size_t k = 0; k < channels; ++k) {
      expected.mean[k] = kFactor * before.values[k];
      expected.sums[k] += 5.0 * expected.mean[k];
    }
    on_every_target([&] {
      Arrays got = before;
      set_mean({channels, before.values.data(), kFactor}, got.mean.data());
      add_samples({channels, before.values.data(), kFactor}, 5.0, got.sums.data());
      EXPECT_EQ(got.mean, expected.mean) << channels;
      EXPECT_EQ(got.sums, expected.sums) << channels;
    });
  }
}

}  // namespace
}  // namespace kiloband::film
