// The tables behind the sampling of environment maps.
#include "scene/compile/light/envmap_sampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace kiloband::test::envmap_sampling_test {
namespace {

constexpr double kPi = 3.141592653589793238463;

void expect_valid_cdf(const float* cdf, uint32_t count) {
  EXPECT_EQ(cdf[0], 0);
  EXPECT_EQ(cdf[count], 1);
  for (uint32_t i = 0; i < count; ++i) {
    ASSERT_GT(cdf[i + 1], cdf[i]);
    ASSERT_EQ(cdf[i] * 0x1p24f, std::floor(cdf[i] * 0x1p24f));  // whole units
  }
}

double probability(const EnvmapSampling& s, uint32_t row, uint32_t column) {
  const float* cdf = &s.row_cdf[row * (s.width + 1)];
  return static_cast<double>(s.marginal_cdf[row + 1] - s.marginal_cdf[row]) * (cdf[column + 1] - cdf[column]);
}

TEST(EnvmapSampling, WeightsAreWhatThePatchesHaveAboveTheMean) {
  constexpr uint32_t kWidth = 4, kHeight = 4;
  std::vector<float> texels;
  for (uint32_t i = 0; i < kWidth * kHeight; ++i) texels.push_back(static_cast<float>(1 + (i * 5) % 7));
  const EnvmapSampling s = build_envmap_sampling(kWidth, kHeight, texels);
  ASSERT_EQ(s.width, 4u);
  ASSERT_EQ(s.height, 3u);
  // Reference: midpoint sums of the interpolated map times sin theta.
  double integrals[3][4], total = 0;
  for (uint32_t row = 0; row < 3; ++row) {
    for (uint32_t column = 0; column < 4; ++column) {
      double sum = 0;
      for (int a = 0; a < 2000; ++a) {
        const double fy = (a + 0.5) / 2000;
        const auto mean = [&](uint32_t j) {
          return 0.5 * (texels[4 * j + column] + texels[4 * j + (column + 1) % 4]);
        };
        sum += ((1 - fy) * mean(row) + fy * mean(row + 1)) * std::sin(kPi * (row + fy) / 3);
      }
      integrals[row][column] = sum / 2000 * (kPi / 3) * (2 * kPi / 4);
      total += integrals[row][column];
    }
  }
  const auto solid_angle = [](uint32_t row) {
    return 2 * kPi / 4 * (std::cos(kPi * row / 3) - std::cos(kPi * (row + 1) / 3));
  };
  const auto excess = [&](uint32_t row, uint32_t column) {
    return std::max(integrals[row][column] - total * solid_angle(row) / (4 * kPi), 0.0);
  };
  double above = 0;
  int below = 0;
  for (uint32_t row = 0; row < 3; ++row) {
    for (uint32_t column = 0; column < 4; ++column) {
      above += excess(row, column);
      below += excess(row, column) == 0;
    }
  }
  EXPECT_GE(below, 3);
  for (uint32_t row = 0; row < 3; ++row) {
    for (uint32_t column = 0; column < 4; ++column) {
      const double expected = (1 - kEnvmapUniformShare) * excess(row, column) / above +
                              kEnvmapUniformShare * solid_angle(row) / (4 * kPi);
      EXPECT_NEAR(probability(s, row, column), expected, 3e-7);
    }
  }
}

TEST(EnvmapSampling, NoCellIsImpossibleBesideASun) {
  // One texel 1e12 times as bright as the others, which are black.
  constexpr uint32_t kWidth = 512, kHeight = 257;
  std::vector<float> texels(kWidth * kHeight, 0.0f);
  texels[40 * kWidth + 511] = 1e12f;
  const EnvmapSampling s = build_envmap_sampling(kWidth, kHeight, texels);
  expect_valid_cdf(s.marginal_cdf.data(), s.height);
  for (uint32_t row = 0; row < s.height; ++row) expect_valid_cdf(&s.row_cdf[row * (kWidth + 1)], kWidth);
  // The sun lights four patches, two of them on either side of the seam.
  double sun = 0;
  for (const uint32_t row : {39u, 40u}) sun += probability(s, row, 510) + probability(s, row, 511);
  EXPECT_NEAR(sun, 1 - kEnvmapUniformShare, 1e-3);
}

TEST(EnvmapSampling, BlackAndSmallestMapsAreUniform) {
  const EnvmapSampling black = build_envmap_sampling(8, 5, std::vector<float>(40, 0.0f));
  const EnvmapSampling even = build_envmap_sampling(8, 5, std::vector<float>(40, 3.0f));
  for (uint32_t row = 0; row < 4; ++row) {
    const double expected = (std::cos(kPi * row / 4) - std::cos(kPi * (row + 1) / 4)) / 16;
    for (uint32_t column = 0; column < 8; ++column) {
      EXPECT_NEAR(probability(black, row, column), expected, 2e-7);
      EXPECT_NEAR(probability(even, row, column), expected, 2e-7);
    }
  }
  const EnvmapSampling one = build_envmap_sampling(1, 1, std::vector<float>{2.0f});
  EXPECT_EQ(one.marginal_cdf, (std::vector<float>{0, 1}));
  EXPECT_EQ(one.row_cdf, (std::vector<float>{0, 1}));
}

TEST(EnvmapSampling, RefusesNonsense) {
  EXPECT_THROW(build_envmap_sampling(0, 1, {}), std::logic_error);
  EXPECT_THROW(build_envmap_sampling(2, 2, std::vector<float>(3)), std::logic_error);
  EXPECT_THROW(build_envmap_sampling(1, 1, std::vector<float>{-1.0f}), std::logic_error);
  EXPECT_THROW(build_envmap_sampling(1, 1, std::vector<float>{std::numeric_limits<float>::infinity()}),
               std::logic_error);
}

}  // namespace
}  // namespace kiloband::test::envmap_sampling_test
