// Warps: samples against densities, densities against 1, closed forms.
#include "shared/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/unit/shared/chi_square.hpp"

namespace {

using kiloband::testing_tools::chi_square_test;
using kiloband::testing_tools::DirectionGrid;
using kiloband::testing_tools::DirectionTest;
using kiloband::testing_tools::kMaxZ;
using kiloband::testing_tools::kTestLevel;
using kiloband::testing_tools::test_directions;
using kiloband::testing_tools::uniform_pair;
using kiloband::testing_tools::z_score;

constexpr uint32_t kSamples = 200'000;  // 400 cells: RMS errors from 2.9 % on are found

double length(const KbFloat3& v) {
  return std::sqrt(double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z);
}

// Equal areas of the disk in polar cells, 20 rings of equal area and 20 sectors.
TEST(Warp, ConcentricDiskIsUniform) {
  std::vector<double> observed(400), expected(400, kSamples / 400.0);
  for (uint32_t i = 0; i < kSamples; ++i) {
    const auto [u, v] = uniform_pair(1, i);
    const KbFloat2 p = kb_disk_concentric(u, v);
    const double r2 = double{p.x} * p.x + double{p.y} * p.y;
    ASSERT_LE(r2, 1 + 1e-6);
    const int ring = std::min(static_cast<int>(r2 * 20), 19);
    const int sector = std::min(static_cast<int>((std::atan2(p.y, p.x) / 6.2831853072 + 0.5) * 20), 19);
    observed[20 * ring + sector] += 1;
  }
  EXPECT_GT(chi_square_test(observed, expected).p_value, kTestLevel);
}

TEST(Warp, ConcentricDiskMapsSquaresToCircles) {
  EXPECT_EQ(kb_disk_concentric(0.5f, 0.5f).x, 0.0f);
  EXPECT_EQ(kb_disk_concentric(0.5f, 0.5f).y, 0.0f);
  for (int i = 0; i <= 64; ++i) {  // the border of the square of half the size: radius 1/2
    const float t = 0.25f + 0.5f * static_cast<float>(i) / 64;
    for (const auto& [u, v] : {std::pair{t, 0.25f}, {t, 0.75f}, {0.25f, t}, {0.75f, t}}) {
      const KbFloat2 p = kb_disk_concentric(u, v);
      EXPECT_NEAR(std::hypot(p.x, p.y), 0.5, 1e-6);
    }
  }
}

TEST(Warp, CosineHemisphereMatchesItsDensity) {
  const DirectionGrid grid;  // the whole sphere: nothing may fall below the horizon
  const auto sample = [](float u, float v) { return std::optional(kb_hemisphere_cosine(u, v)); };
  const auto density = [](const KbFloat3& w) { return kb_hemisphere_cosine_pdf(w.z); };
  const DirectionTest test = test_directions(grid, 2, kSamples, sample, density);
  EXPECT_NEAR(test.integral, 1, 1e-3);  // the kink at the horizon limits the quadrature
  EXPECT_GT(test.chi_square.p_value, kTestLevel);
}

TEST(Warp, SphereMatchesItsDensity) {
  const DirectionGrid grid;
  const auto sample = [](float u, float v) { return std::optional(kb_sphere_uniform(u, v)); };
  const auto density = [](const KbFloat3&) { return kb_sphere_uniform_pdf(); };
  const DirectionTest test = test_directions(grid, 3, kSamples, sample, density);
  EXPECT_NEAR(test.integral, 1, 1e-6);
  EXPECT_GT(test.chi_square.p_value, kTestLevel);
}

TEST(Warp, ConeMatchesItsDensity) {
  for (const double angle : {3.0, 1.0, 0.1, 1e-3}) {
    DirectionGrid grid;
    grid.theta_max = angle;
    const float one_minus_cos = static_cast<float>(2 * std::pow(std::sin(angle / 2), 2));
    const auto sample = [=](float u, float v) {
      KbFloat3 w = kb_cone_uniform(u, v, one_minus_cos);
      // the last ulp of a float cone may lie beyond the exact angle: pull the rim in by 1e-6
      const float pull = 1 - 1e-6f;
      w.x *= pull;
      w.y *= pull;
      return std::optional(w);
    };
    const auto density = [=](const KbFloat3&) { return kb_cone_uniform_pdf(one_minus_cos); };
    const DirectionTest test = test_directions(grid, 4, kSamples, sample, density);
    EXPECT_NEAR(test.integral, 1, 1e-5) << angle;
    EXPECT_GT(test.chi_square.p_value, kTestLevel) << angle;
  }
}

// A star 1e-6 rad wide: cos rounds to 1 in float.
// The radius must still be spread like sqrt(u) and the density finite.
TEST(Warp, TinyConeKeepsItsShape) {
  const double angle = 1e-6;
  const float one_minus_cos = kb_one_minus_cos(static_cast<float>(std::sin(angle) * std::sin(angle)));
  EXPECT_NEAR(one_minus_cos, angle * angle / 2, 1e-6 * angle * angle);
  EXPECT_NEAR(kb_cone_uniform_pdf(one_minus_cos) * 3.14159265358979 * angle * angle, 1, 1e-5);
  for (const float u : {0.01f, 0.25f, 0.5f, 0.99f}) {
    const KbFloat3 w = kb_cone_uniform(u, 0.3f, one_minus_cos);
    EXPECT_NEAR(std::hypot(w.x, w.y) / (angle * std::sqrt(u)), 1, 1e-5);
    EXPECT_NEAR(length(w), 1, 1e-6);
  }
}

TEST(Warp, OneMinusCosIsExactAtBothEnds) {
  EXPECT_EQ(kb_one_minus_cos(0.0f), 0.0f);
  EXPECT_EQ(kb_one_minus_cos(1.0f), 1.0f);
  for (double s2 = 1e-12; s2 < 1; s2 *= 1.7) {
    const double exact = s2 / (1 + std::sqrt(1 - s2));
    EXPECT_NEAR(kb_one_minus_cos(static_cast<float>(s2)), exact, 4e-7 * exact / std::sqrt(1 - s2));
  }
}

TEST(Warp, DirectionsAreUnitVectors) {
  for (uint32_t i = 0; i < 10'000; ++i) {
    const auto [u, v] = uniform_pair(5, i);
    for (const KbFloat3& w :
         {kb_hemisphere_cosine(u, v), kb_sphere_uniform(u, v), kb_cone_uniform(u, v, 0.3f)})
      ASSERT_NEAR(length(w), 1, 4e-7);
  }
}

// Uniform on the triangle: the affine map that takes barycentrics to a 16 x 16 grid of equal parallelograms;
// cells on the diagonal have half the area. Also the centroid: mean b = 1/3, z test at one failure in 1e6,
// bias 0.1 % found.
TEST(Warp, TriangleIsUniform) {
  std::vector<double> observed(256), expected(256);
  std::vector<double> b1, b2;
  for (int i = 0; i < 16; ++i)
    for (int j = 0; i + j < 16; ++j) expected[16 * i + j] = kSamples * (i + j == 15 ? 1 : 2) / 256.0;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const auto [u, v] = uniform_pair(6, i);
    const KbFloat2 b = kb_triangle_uniform(u, v);
    ASSERT_GE(b.x, 0.0f);
    ASSERT_GE(b.y, 0.0f);
    ASSERT_LE(b.x + b.y, 1.0f);
    observed[16 * std::min(static_cast<int>(b.x * 16), 15) + std::min(static_cast<int>(b.y * 16), 15)] += 1;
    b1.push_back(b.x);
    b2.push_back(b.y);
  }
  EXPECT_GT(chi_square_test(observed, expected).p_value, kTestLevel);
  EXPECT_LT(std::fabs(z_score(b1, 1.0 / 3)), kMaxZ);
  EXPECT_LT(std::fabs(z_score(b2, 1.0 / 3)), kMaxZ);
}

TEST(Warp, PowerHeuristicSumsToOneAtAnySize) {
  EXPECT_FLOAT_EQ(kb_power_heuristic(3, 4), 9.0f / 25);
  for (const float scale : {1e-30f, 1e-5f, 1.0f, 1e30f})
    EXPECT_NEAR(kb_power_heuristic(2 * scale, 5 * scale) + kb_power_heuristic(5 * scale, 2 * scale), 1, 1e-6);
  EXPECT_EQ(kb_power_heuristic(0, 1), 0.0f);
  EXPECT_EQ(kb_power_heuristic(0, 0), 0.0f);
  EXPECT_EQ(kb_power_heuristic(1, 0), 1.0f);
  EXPECT_EQ(kb_power_heuristic(std::numeric_limits<float>::infinity(), 1), 1.0f);
  EXPECT_EQ(kb_power_heuristic(1e-30f, 1e30f), 0.0f);
}

}  // namespace
