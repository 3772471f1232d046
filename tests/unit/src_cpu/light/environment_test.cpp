// Environment maps in double precision.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/compile/light/envmap_facings.hpp"
#include "test_scene.hpp"
#include "tests/support/envmap_table.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::environment_test {
namespace {

using namespace cpu;

constexpr double kPi = 3.141592653589793238463;

double around(double a, double b) {
  const double difference = std::fabs(a - b);
  return std::min(difference, 1 - difference);
}

/// An eighth of the directions stands within 1e-3 of a pole, an eighth at the seam.
TEST(EnvmapCoordinates, AreThoseOfDoublePrecision) {
  const KbEmitter emitter = make_emitter(KB_EMITTER_ENVMAP);
  Uniform uniform(1);
  for (int i = 0; i < 100000; ++i) {
    glm::dvec3 d = random_direction(uniform);
    if (i % 8 == 0) d = {1e-3 * d.x, d.y, 1e-3 * d.z};
    if (i % 8 == 1) d = {1e-6 * d.x, d.y, -std::fabs(d.z)};
    const glm::vec3 direction(glm::normalize(d));
    const glm::dvec3 exact(direction);
    const glm::vec2 uv = envmap_coordinates(emitter, direction);
    ASSERT_TRUE(uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y <= 1);
    ASSERT_LT(around(uv.x, std::atan2(exact.x, -exact.z) / (2 * kPi)), 1.5e-7) << i;
    const double v = std::atan2(std::hypot(exact.x, exact.z), exact.y) / kPi;
    ASSERT_LT(std::fabs(uv.y - v), 1.5e-7) << i;
    if (v < 0.1) {
      ASSERT_LT(std::fabs(uv.y - v), 4e-7 * v) << i;
    }
  }
}

/// Facings as defined, in double precision; a normal at a cell's border may go to either side.
TEST(EnvironmentFacing, IsTheCellOfTheNormalInTheMapsFrame) {
  const KbEmitter emitter = make_emitter(KB_EMITTER_ENVMAP, placed({1, 2, 3}, 1.1, glm::dvec3(2)));
  const glm::dmat3 to_world(placed({0, 0, 0}, 1.1, glm::dvec3(1)));
  Uniform uniform(5);
  int other = 0;
  for (int i = 0; i < 100000; ++i) {
    const glm::vec3 normal(random_direction(uniform));
    const uint32_t facing = environment_facing(emitter, normal);
    ASSERT_LT(facing, KB_FACINGS);
    other += facing != facing_of_normal(glm::transpose(to_world) * glm::dvec3(normal));
  }
  EXPECT_LE(other, 5);
  for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0, 0, 0), glm::vec3(NAN)})
    EXPECT_LT(environment_facing(emitter, axis), KB_FACINGS);
}

/// The solid angle of rows by either pole of a map that is as high as maps may be.
TEST(EnvmapDensity, KeepsItsDigitsAtBothPoles) {
  constexpr uint32_t kHeight = 65536, kRows = kHeight - 1;
  const EnvmapSampling sampling = build_envmap_sampling(1, kHeight, std::vector<float>(kHeight, 1.0f));
  for (const uint32_t row : {0u, 1u, 2u, 77u, kRows / 2, kRows - 78, kRows - 3, kRows - 2, kRows - 1}) {
    const double probability = envmap_probability(sampling, row, 0);
    const double step = kPi / kRows, from_pole = std::min(row, kRows - 1 - row);
    const double solid_angle = 4 * kPi * std::sin((from_pole + 0.5) * step) * std::sin(0.5 * step);
    const auto v = static_cast<float>((row + 0.5) / kRows);
    EXPECT_NEAR(envmap_density(sampling, {0.3f, v}) * solid_angle / probability, 1, 1e-6) << row;
  }
}

}  // namespace
}  // namespace kiloband::test::environment_test
