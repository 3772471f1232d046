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

TEST(Warp, SphereMatchesItsDensity) {
  const DirectionGrid grid;
  const auto sample = [](float u, float v) { return std::optional(kb_sphere_uniform(u, v)); };
  const auto density = [](const KbFloat3&) { return 0.25f * KB_INV_PI; };
  const DirectionTest test = test_directions(grid, 3, kSamples, sample, density);
  EXPECT_NEAR(test.integral, 1, 1e-6);
  EXPECT_GT(test.chi_square.p_value, kTestLevel);
}

// 1 over the solid angle, also of a star 1e-6 rad wide, whose cosine rounds to 1 in float.
TEST(Warp, ConeDensityIsOneOverItsSolidAngle) {
  for (const double angle : {3.0, 1.0, 0.1, 1e-3, 1e-6}) {
    const double one_minus_cos = 2 * std::pow(std::sin(angle / 2), 2);
    EXPECT_NEAR(kb_cone_uniform_pdf(static_cast<float>(one_minus_cos)) * 2 * 3.14159265358979 * one_minus_cos,
                1, 1e-6);
  }
}

TEST(Warp, DirectionsAreUnitVectors) {
  for (uint32_t i = 0; i < 10'000; ++i) {
    const auto [u, v] = uniform_pair(5, i);
    ASSERT_NEAR(length(kb_sphere_uniform(u, v)), 1, 4e-7);
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

}  // namespace
