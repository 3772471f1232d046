// The tables behind the sampling of environment maps.
#include "scene/compile/light/envmap_sampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "scene/compile/light/envmap_facings.hpp"
#include "tests/support/envmap_table.hpp"

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

/// All distributions that lead to cells, for every facing: whole units, and `possible` says which may have none.
template <class Possible>
void expect_valid_tables(const EnvmapSampling& s, const Possible& possible) {
  const std::size_t down = s.regions_down(), across = s.regions_across();
  const std::size_t rows = std::size_t{1} << s.row_shift, columns = std::size_t{1} << s.column_shift;
  ASSERT_EQ(s.facing_cdf.size(), (KB_ALL_FACINGS + 1) * (down + 1 + down * (across + 1)));
  ASSERT_EQ(s.row_cdf.size(), down * across * (rows + 1));
  ASSERT_EQ(s.column_cdf.size(), s.height * across * (columns + 1));
  for (uint32_t i = 0; i < s.height; ++i) {
    for (std::size_t c = 0; c < across; ++c) {
      const EnvmapCell at(s, i, static_cast<uint32_t>(c << s.column_shift), KB_ALL_FACINGS);
      expect_valid_cdf(at.column, static_cast<uint32_t>(std::min(columns, s.width - (c << s.column_shift))));
      expect_valid_cdf(at.row,
                       static_cast<uint32_t>(std::min<std::size_t>(rows, s.height - (i & ~(rows - 1)))));
    }
  }
  for (uint32_t facing = 0; facing <= KB_ALL_FACINGS; ++facing)
    for (uint32_t i = 0; i < s.height; ++i)
      for (uint32_t j = 0; j < s.width; ++j)
        ASSERT_EQ(envmap_probability(s, i, j, facing) > 0, possible(facing, i, j))
            << facing << " " << i << " " << j;
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
      EXPECT_NEAR(envmap_probability(s, row, column), expected, 3e-7);
    }
  }
}

TEST(EnvmapSampling, NoCellIsImpossibleBesideASun) {
  // One texel 1e12 times as bright as the others, which are black.
  constexpr uint32_t kWidth = 512, kHeight = 257;
  std::vector<float> texels(kWidth * kHeight, 0.0f);
  texels[40 * kWidth + 511] = 1e12f;
  const EnvmapSampling s = build_envmap_sampling(kWidth, kHeight, texels);
  // But for regions that a facing does not see.
  std::vector<std::vector<double>> seen;
  for (uint32_t facing = 0; facing <= KB_ALL_FACINGS; ++facing)
    seen.push_back(envmap_facing_weights(s, facing));
  expect_valid_tables(s, [&](uint32_t facing, uint32_t i, uint32_t j) {
    return seen[facing][(i >> s.row_shift) * s.regions_across() + (j >> s.column_shift)] > 0;
  });
  // The sun lights four patches, two of them on either side of the seam.
  double sun = 0;
  for (const uint32_t row : {39u, 40u})
    sun += envmap_probability(s, row, 510) + envmap_probability(s, row, 511);
  EXPECT_NEAR(sun, 1 - kEnvmapUniformShare, 1e-3);
}

TEST(EnvmapSampling, BlackAndSmallestMapsAreUniform) {
  const EnvmapSampling black = build_envmap_sampling(8, 5, std::vector<float>(40, 0.0f));
  const EnvmapSampling even = build_envmap_sampling(8, 5, std::vector<float>(40, 3.0f));
  for (uint32_t row = 0; row < 4; ++row) {
    const double expected = (std::cos(kPi * row / 4) - std::cos(kPi * (row + 1) / 4)) / 16;
    for (uint32_t column = 0; column < 8; ++column) {
      EXPECT_NEAR(envmap_probability(black, row, column), expected, 2e-7);
      EXPECT_NEAR(envmap_probability(even, row, column), expected, 2e-7);
    }
  }
  const EnvmapSampling one = build_envmap_sampling(1, 1, std::vector<float>{2.0f});
  EXPECT_EQ(one.row_cdf, (std::vector<float>{0, 1}));
  EXPECT_EQ(one.column_cdf, (std::vector<float>{0, 1}));
}

/// For a facing: what the map gives a region times the facing's weight of it, and within the region as the map has it.
TEST(EnvmapSampling, FacingsAreProductsOfMapAndWeights) {
  constexpr uint32_t kWidth = 70, kHeight = 36;  // regions of 4 x 4 cells, the last ones smaller
  std::vector<float> texels;
  for (uint32_t i = 0; i < kWidth * kHeight; ++i) texels.push_back(static_cast<float>(1 + (i * 13) % 37));
  const EnvmapSampling s = build_envmap_sampling(kWidth, kHeight, texels);
  ASSERT_EQ(s.row_shift, 2u);
  ASSERT_EQ(s.column_shift, 2u);
  ASSERT_EQ(s.regions_down(), 9u);
  ASSERT_EQ(s.regions_across(), 18u);
  const auto region = [&](uint32_t i, uint32_t j) { return (i >> 2) * 18 + (j >> 2); };
  for (const uint32_t facing : {0u, 9u, 27u, 36u, 63u}) {
    const std::vector<double> weights = envmap_facing_weights(s, facing);
    double total = 0;
    for (uint32_t i = 0; i < s.height; ++i)
      for (uint32_t j = 0; j < s.width; ++j) total += weights[region(i, j)] * envmap_probability(s, i, j);
    double sum = 0;
    for (uint32_t i = 0; i < s.height; ++i) {
      for (uint32_t j = 0; j < s.width; ++j) {
        const double p = envmap_probability(s, i, j, facing);
        ASSERT_NEAR(p, weights[region(i, j)] * envmap_probability(s, i, j) / total, 3e-7);
        sum += p;
      }
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

/// Every facing's normals lie in it, all of them cover the sphere once; weights are cosines, where a region is seen at all.
TEST(EnvmapFacings, AreCellsOfTheSphereAndSeeWhatLiesAbove) {
  const EnvmapSampling s = build_envmap_sampling(32, 17, std::vector<float>(32 * 17, 1.0f));
  glm::dvec3 sum(0);
  for (uint32_t facing = 0; facing < KB_FACINGS; ++facing) {
    for (const double x : {0.01, 0.5, 0.99})
      for (const double y : {0.01, 0.5, 0.99}) {
        ASSERT_EQ(facing_of_normal(3.0 * facing_normal(facing, x, y)), facing) << x << " " << y;
        ASSERT_NEAR(glm::length(facing_normal(facing, x, y)), 1, 1e-14);
        sum += facing_normal(facing, x, y);
      }
    const glm::dvec3 middle = facing_normal(facing, 0.5, 0.5);
    const std::vector<double> weights = envmap_facing_weights(s, facing);
    for (uint32_t i = 0; i < 16; ++i) {
      for (uint32_t j = 0; j < 32; ++j) {
        const double theta = kPi * (i + 0.5) / 16, phi = 2 * kPi * (j + 1.0) / 32;
        const double cosine = glm::dot(middle, glm::dvec3(std::sin(phi) * std::sin(theta), std::cos(theta),
                                                          -std::cos(phi) * std::sin(theta)));
        // A facing reaches 20 degrees from its middle, a region 8.
        const double weight = weights[i * 32 + j];
        ASSERT_NEAR(weight, std::max(cosine, 0.0) + (weight > 0 ? kLeastFacingWeight : 0), 0.12) << cosine;
        ASSERT_FALSE(cosine < -0.5 && weight > 0) << weight;
        ASSERT_FALSE(cosine > 0.1 && weight <= kLeastFacingWeight) << weight;
      }
    }
  }
  EXPECT_LT(glm::length(sum), 1e-12);
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
