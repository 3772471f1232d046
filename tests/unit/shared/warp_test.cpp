// Warps: samples against densities, densities against 1, closed forms.
#include "shared/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/chi_square.hpp"

namespace kiloband::test {
namespace {

constexpr double kPi = 3.14159265358979324;
constexpr int kSamples = 200'000;  // 400 cells: RMS errors from 2.9 % on are found

double length(const KbFloat3& v) {
  return std::sqrt(double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z);
}

/// The azimuth of a vector as a part of a turn.
double turn(double x, double y) {
  return std::atan2(y, x) / (2 * kPi) + 0.5;
}

/// Samples of warp(u, v) against density(direction).
ChiSquare test_warp(uint64_t seed, KbFloat3 (*warp)(float, float),
                    const std::function<float(glm::vec3)>& density) {
  Uniform uniform(seed);
  const auto draw = [&]() -> Draw {
    const glm::vec2 u = uniform.pair();
    const KbFloat3 w = warp(u.x, u.y);
    return {glm::vec3(w.x, w.y, w.z)};
  };
  return chi_square(draw, density, 0, kSamples);
}

// Equal areas of the disk in polar cells, 20 rings of equal area and 20 sectors.
TEST(Warp, ConcentricDiskIsUniform) {
  Uniform uniform(1);
  SquareCounts counts(20);
  for (int i = 0; i < kSamples; ++i) {
    const glm::vec2 u = uniform.pair();
    const KbFloat2 p = kb_disk_concentric(u.x, u.y);
    const double r2 = double{p.x} * p.x + double{p.y} * p.y;
    ASSERT_LE(r2, 1 + 1e-6);
    counts.add(r2, turn(p.x, p.y));
  }
  EXPECT_GT(counts.p_value(), kTestLevel);
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
  const ChiSquare test = test_warp(3, kb_sphere_uniform, [](glm::vec3) { return 0.25f * KB_INV_PI; });
  EXPECT_NEAR(test.integral, 1, 1e-6);
  EXPECT_GT(test.p_value, kTestLevel);
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
  Uniform uniform(5);
  for (int i = 0; i < 10'000; ++i) {
    const glm::vec2 u = uniform.pair();
    ASSERT_NEAR(length(kb_sphere_uniform(u.x, u.y)), 1, 4e-7);
  }
}

// Uniform on the triangle: the affine map that takes barycentrics to a 16 x 16 grid of equal parallelograms;
// cells on the diagonal have half the area. Also the centroid: mean b = 1/3, z test at one failure in 1e5,
// bias 0.1 % found.
TEST(Warp, TriangleIsUniform) {
  std::vector<double> observed(256), expected(256);
  std::vector<double> b1, b2;
  for (int i = 0; i < 16; ++i)
    for (int j = 0; i + j < 16; ++j) expected[16 * i + j] = kSamples * (i + j == 15 ? 1 : 2) / 256.0;
  Uniform uniform(6);
  for (int i = 0; i < kSamples; ++i) {
    const glm::vec2 u = uniform.pair();
    const KbFloat2 b = kb_triangle_uniform(u.x, u.y);
    ASSERT_GE(b.x, 0.0f);
    ASSERT_GE(b.y, 0.0f);
    ASSERT_LE(b.x + b.y, 1.0f);
    observed[16 * std::min(static_cast<int>(b.x * 16), 15) + std::min(static_cast<int>(b.y * 16), 15)] += 1;
    b1.push_back(b.x);
    b2.push_back(b.y);
  }
  EXPECT_GT(chi_square(observed, expected).p_value, kTestLevel);
  EXPECT_LT(std::fabs(z_score(b1, 1.0 / 3)), kMaxZ);
  EXPECT_LT(std::fabs(z_score(b2, 1.0 / 3)), kMaxZ);
}

}  // namespace
}  // namespace kiloband::test
