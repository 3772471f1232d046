// Suns: sampled directions against their density, which rays meet them, irradiance, from the smallest disc to a
// hemisphere.
#include <gtest/gtest.h>

#include <cmath>

#include "test_scene.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::sun_test {

using namespace cpu;
namespace {

constexpr double kPi = 3.141592653589793238463;
constexpr double kDegree = kPi / 180;
/// Degrees: the smallest that is allowed, the sun of the Earth, wide ones.
constexpr double kRadii[] = {1e-3, 0.2666, 10, 60, 90};

/// Where a direction lies on the disc, in double: 1 - cos of its angle to the axis, and its azimuth in turns.
struct OnDisc {
  glm::dvec3 axis, x, y;

  explicit OnDisc(const glm::dmat4& to_world) : axis(-glm::normalize(glm::dvec3(to_world[2]))) {
    // The axis as the renderer has it: in float, it may be off by more than a hundredth of the smallest disc.
    float m[12];
    set_matrix(m, to_world);
    const glm::vec3 propagation(m[2], m[6], m[10]);
    axis = -glm::normalize(glm::dvec3(propagation));
    x = glm::normalize(glm::cross(axis, glm::dvec3(0.3, 0.9, -0.2)));
    y = glm::cross(axis, x);
  }
  double height(glm::dvec3 w) const {
    const glm::dvec3 off = glm::normalize(w) - axis;
    return 0.5 * glm::dot(off, off);
  }
  double turn(glm::dvec3 w) const {
    const double t = std::atan2(glm::dot(w, y), glm::dot(w, x)) / (2 * kPi);
    return t < 0 ? t + 1 : t;
  }
};

/// 1 - cos theta and the azimuth are uniform: 400 cells of 500 samples each. A density of 1 + a cos over the disc is found
/// with probability > 0.99 from a = 0.02 on.
TEST(Sun, DirectionsAreUniformOnTheDisc) {
  for (const double degrees : kRadii) {
    SCOPED_TRACE(degrees);
    const double radius = degrees * kDegree, cone = 2 * std::pow(std::sin(radius / 2), 2.0);
    const glm::dmat4 to_world = placed({7, 8, 9}, 1.1, glm::dvec3(1));
    const FlatScene scene = scene_with(make_sun(radius, to_world));
    const OnDisc disc(to_world);
    constexpr int kSide = 20, kSamples = 200000;
    std::vector<double> observed(kSide * kSide), expected(kSide * kSide, double(kSamples) / (kSide * kSide));
    Uniform uniform(31);
    int outside = 0;
    for (int i = 0; i < kSamples; ++i) {
      const LightSample sample = sample_light(scene, glm::vec3(0), {0, 0}, uniform.pair());
      ASSERT_NEAR(sample.pdf * 2 * kPi * cone, 1, 1e-6);
      ASSERT_NEAR(glm::length(glm::dvec3(sample.direction)), 1, 2e-7);
      const double h = disc.height(sample.direction) / cone;
      ASSERT_LT(h, 1 + 2e-7 / radius);
      outside += sun_pdf(scene, 0, sample.direction) == 0;
      const int row = std::min(static_cast<int>(h * kSide), kSide - 1);
      ++observed[row * kSide + std::min(static_cast<int>(disc.turn(sample.direction) * kSide), kSide - 1)];
    }
    // Rounding at the edge: twice 1e-7 of the radius at most, on either side.
    EXPECT_LE(outside, 10 + kSamples * 4e-7 / radius);
    if (degrees >= 0.2) {  // the float directions of the smallest disc are a lattice of some 500 across
      EXPECT_GT(chi_square(observed, expected).p_value, kTestLevel);
    }
  }
}

/// Inside to within 1e-7 rad of the edge, not beyond; the density is the sampling's and integrates to 1.
TEST(Sun, RaysMeetItUpToItsEdge) {
  Uniform uniform(32);
  for (const double degrees : kRadii) {
    SCOPED_TRACE(degrees);
    const double radius = degrees * kDegree;
    const glm::dmat4 to_world = placed({0, 0, 0}, 0.7, glm::dvec3(1));
    KbEmitter sun = make_sun(radius, to_world);
    sun.select_pdf = 0.25f;
    const FlatScene scene = scene_with(sun);
    const OnDisc disc(to_world);
    const float density = sample_light(scene, glm::vec3(0), {0, 0}, {0.5f, 0.5f}).pdf;
    EXPECT_NEAR(density * 2 * kPi * (2 * std::pow(std::sin(radius / 2), 2.0)), 0.25, 1e-6);
    for (int i = 0; i < 2000; ++i) {
      const double phi = 2 * kPi * uniform();
      const auto at = [&](double angle) {
        return glm::vec3(std::cos(angle) * disc.axis +
                         std::sin(angle) * (std::cos(phi) * disc.x + std::sin(phi) * disc.y));
      };
      ASSERT_EQ(sun_pdf(scene, 0, at(radius - 3e-7)), density);
      ASSERT_EQ(sun_pdf(scene, 0, at(radius * uniform() * 0.98)), density);
      ASSERT_EQ(sun_pdf(scene, 0, at(radius + 3e-7)), 0);
      ASSERT_EQ(sun_pdf(scene, 0, at(radius + (kPi - radius) * (0.01 + 0.99 * uniform()))), 0);
    }
  }
}

/// Planes that face the sun get 1, and tilted ones that see the whole disc the cosine: L = 1 / (pi sin^2 r). The error
/// of the mean is below 0.1 %; 4.4 standard errors are allowed.
TEST(Sun, IrradianceIsThatOfItsSpectrum) {
  for (const double degrees : kRadii)
    for (const double tilt : {0.0, 0.3, 0.95}) {
      if (degrees + tilt * 90 > 90.001) continue;
      SCOPED_TRACE(std::to_string(degrees) + " tilted by " + std::to_string(tilt * 90));
      const glm::dmat4 to_world = placed({7, 8, 9}, 2.3, glm::dvec3(1));
      const FlatScene scene = scene_with(make_sun(degrees * kDegree, to_world));
      const OnDisc disc(to_world);
      const glm::dvec3 normal = std::cos(tilt * 0.5 * kPi) * disc.axis + std::sin(tilt * 0.5 * kPi) * disc.x;
      Uniform uniform(33);
      constexpr int kSamples = 200000;
      double sum = 0, sum2 = 0;
      for (int i = 0; i < kSamples; ++i) {
        const LightSample sample = sample_light(scene, glm::vec3(0), {0, 0}, uniform.pair());
        EXPECT_TRUE(sample.infinite && !sample.delta);
        const double value = sample.factor * glm::dot(glm::dvec3(sample.direction), normal) / sample.pdf;
        sum += value, sum2 += value * value;
      }
      const double mean = sum / kSamples, expected = std::cos(tilt * 0.5 * kPi);
      const double error = std::sqrt(std::max(0.0, sum2 / kSamples - mean * mean) / kSamples);
      EXPECT_LT(error, 2e-3 * expected);
      EXPECT_NEAR(mean, expected, kMaxZ * error + 1e-6);
    }
}

}  // namespace
}  // namespace kiloband::test::sun_test
