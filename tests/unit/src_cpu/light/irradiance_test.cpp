// Irradiance by light sampling, E = mean of L cos / pdf with L = 1, against closed forms.
//
// Each z test has an error rate of 1e-5 (|z| < 4.42) and finds, with probability 0.95, a bias of 6.1 standard
// errors, which every test asserts to be below 1 % of the result.
#include <gtest/gtest.h>

#include "scene/compile/light/envmap_sampling.hpp"
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "test_scene.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::irradiance_test {

using namespace cpu;
namespace {

constexpr double kPi = 3.141592653589793238463;
constexpr int kSamples = 1200000;

void expect_irradiance(const FlatScene& scene, glm::vec3 point, glm::vec3 normal, double expected,
                       uint32_t seed, int samples = kSamples) {
  Uniform uniform(seed);
  double sum = 0, sum2 = 0;
  for (int i = 0; i < samples; ++i) {
    const glm::vec2 select = uniform.pair();
    const LightSample sample = sample_light(scene, point, select, uniform.pair());
    const float cosine = std::max(glm::dot(sample.direction, normal), 0.0f);
    if (!(sample.pdf > 0)) continue;
    const float radiance = sample.radiance.textured ? bitmap_value(scene, sample.radiance.texture) : 1;
    const double value = sample.factor * radiance * cosine / sample.pdf;
    sum += value;
    sum2 += value * value;
  }
  const double mean = sum / samples;
  const double error = std::sqrt(std::max(sum2 / samples - mean * mean, 0.0) / samples) + 1e-6 * expected;
  EXPECT_LT(std::fabs(mean - expected) / error, kMaxZ) << mean << " instead of " << expected;
  EXPECT_LT(6.1 * error, 1e-2 * expected);
}

/// Lambert's formula: E = 1/2 |sum of (angle of an edge) * (its normal, unit) .
/// n| for a polygon above the horizon.
double polygon_irradiance(const std::vector<glm::dvec3>& vertices, glm::dvec3 point, glm::dvec3 normal) {
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const glm::dvec3 a = glm::normalize(vertices[i] - point);
    const glm::dvec3 b = glm::normalize(vertices[(i + 1) % vertices.size()] - point);
    const glm::dvec3 c = glm::cross(a, b);
    sum += std::atan2(glm::length(c), glm::dot(a, b)) * glm::dot(glm::normalize(c), normal);
  }
  return 0.5 * std::fabs(sum);
}

TEST(Irradiance, Sphere) {
  // pi (R / d)^2 cos, at three distances;
  // the last nearly touches (horizon still below the sphere for n towards it).
  for (const double d : {1.001, 2.5, 1e4}) {
    const FlatScene scene =
        scene_with_light(make_shape(KB_SHAPE_SPHERE, placed({0, 0, d}, 0.5, glm::dvec3(1))));
    const auto far = static_cast<double>(static_cast<float>(d));
    expect_irradiance(scene, glm::vec3(0), {0, 0, 1}, kPi / (far * far), 1);
  }
  const FlatScene scene =
      scene_with_light(make_shape(KB_SHAPE_SPHERE, placed({0, 0, 3}, 0.5, glm::dvec3(1))));
  const glm::dvec3 tilted = glm::normalize(glm::dvec3(1, 0.5, 1));
  expect_irradiance(scene, glm::vec3(0), glm::vec3(tilted), kPi / 9 * tilted.z, 2);
}

TEST(Irradiance, InsideASphere) {
  const KbShape shape =
      make_shape(KB_SHAPE_SPHERE, placed({1, 0, 0}, 0.5, glm::dvec3(2)), KB_SHAPE_FLIP_NORMALS);
  expect_irradiance(scene_with_light(shape), {1.5f, 0.7f, -0.4f}, {0, 0.6f, 0.8f}, kPi, 3);
}

TEST(Irradiance, DiskOnAxis) {
  // pi r^2 / (r^2 + h^2)
  const KbShape shape = make_shape(KB_SHAPE_DISK, placed({0, 0, 0}, 0.5, {0.7, 0.7, 1}));
  const glm::vec3 normal = analytic_surface(shape, glm::dvec3(0)).normal;
  expect_irradiance(scene_with_light(shape), 1.5f * normal, -normal, kPi * 0.49 / (0.49 + 2.25), 4);
}

TEST(Irradiance, Rectangle) {
  const std::vector<KbFloat3> corners{{-1, -1, 2}, {-1, 1.5f, 2}, {2, 1.5f, 2.5f}, {2, -1, 2.5f}};
  const FlatScene scene = scene_with_mesh(corners, {0, 1, 2, 0, 2, 3});
  std::vector<glm::dvec3> polygon;
  for (const KbFloat3& p : corners) polygon.emplace_back(p.x, p.y, p.z);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.2, -0.1, 1));
  expect_irradiance(scene, glm::vec3(0.1f, 0.3f, 0), glm::vec3(normal),
                    polygon_irradiance(polygon, {0.1f, 0.3f, 0}, normal), 5);
}

TEST(Irradiance, InsideATube) {
  // A tube of radius 1 and length 2 h about a point on its axis, n along the axis: the disk's end is dark,
  // and the wall gives pi - pi / (1 + h^2).
  const KbShape shape =
      make_shape(KB_SHAPE_CYLINDER, placed({0, 0, -3}, 0, {1, 1, 6}), KB_SHAPE_FLIP_NORMALS);
  expect_irradiance(scene_with_light(shape), glm::vec3(0), {0, 0, 1}, kPi - kPi / 10, 6);
}

TEST(Irradiance, ConstantEnvironment) {
  expect_irradiance(scene_with(make_emitter(KB_EMITTER_CONSTANT)), glm::vec3(0), {0.6f, 0, 0.8f}, kPi, 7);
}

// The map's radiance in plain double arithmetic, from the formulas of the conventions.
double map_radiance(const std::vector<float>& texels, int width, int height, glm::dvec3 d) {
  const double u = std::atan2(d.x, -d.z) / (2 * kPi), v = std::acos(std::clamp(d.y, -1.0, 1.0)) / kPi;
  const double x = u * width - 0.5, y = v * (height - 1);
  const int x0 = static_cast<int>(std::floor(x)), y0 = std::min(static_cast<int>(y), height - 2);
  const auto at = [&](int i, int j) { return texels[j * width + ((i % width) + width) % width]; };
  const double fx = x - x0, fy = y - y0;
  return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
         fy * ((1 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
}

TEST(Irradiance, RotatedEnvironmentMap) {
  constexpr int kWidth = 12, kHeight = 7;
  std::vector<float> texels;
  for (int i = 0; i < kWidth * kHeight; ++i)
    texels.push_back(0.1f + static_cast<float>((i * 37) % 11) * 0.2f);
  texels[2 * kWidth + 11] = 60;
  const glm::dmat4 to_world = placed({0, 0, 0}, 0.8, glm::dvec3(1));
  const FlatScene scene = envmap_scene(kWidth, kHeight, texels, to_world);

  const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.3, 1, 0.2));
  const glm::dmat3 to_map = glm::transpose(glm::dmat3(to_world));
  Uniform uniform(9);
  const auto draw = [&] { return Draw{glm::vec3(random_direction(uniform))}; };
  const double expected = integral_over_sphere(draw, [&](glm::dvec3 d) {
    return map_radiance(texels, kWidth, kHeight, to_map * d) * std::max(glm::dot(d, normal), 0.0);
  });
  // Samples of maps leave what is not above the mean to BSDFs: without those they are noisy.
  expect_irradiance(scene, glm::vec3(0), glm::vec3(normal), expected, 8, 4 * kSamples);
}

/// Direction about a normal with density cos / pi.
glm::vec3 cosine_direction(Uniform& uniform, glm::dvec3 normal) {
  const glm::dvec3 d = normal * (1 - 1e-9) + random_direction(uniform);
  return glm::vec3(glm::normalize(d));
}

/// One sample of the map for the receiver's facing and one with density cos / pi, by the power heuristic, as a path tracer takes
/// them: what a facing does not see at all is left to the other technique.
TEST(Irradiance, OfEveryFacingByBothTechniques) {
  constexpr int kWidth = 40, kHeight = 21;
  std::vector<float> texels;
  for (int i = 0; i < kWidth * kHeight; ++i)
    texels.push_back(0.1f + static_cast<float>((i * 37) % 11) * 0.2f);
  texels[6 * kWidth + 39] = 60;
  texels[15 * kWidth + 7] = 20;
  const glm::dmat4 to_world = placed({0, 0, 0}, 0.8, glm::dvec3(1));
  const FlatScene scene = envmap_scene(kWidth, kHeight, texels, to_world);
  const glm::dmat3 to_map = glm::transpose(glm::dmat3(to_world));
  Uniform uniform(31);
  for (int receiver = 0; receiver < 6; ++receiver) {
    const glm::dvec3 normal = random_direction(uniform);
    const uint32_t facing = environment_facing(scene.emitters[0], glm::vec3(normal));
    const auto radiance = [&](glm::dvec3 d) { return map_radiance(texels, kWidth, kHeight, to_map * d); };
    const auto share = [&](glm::vec3 d, double pdf, double other) {
      const double cosine = std::max(glm::dot(glm::dvec3(d), normal), 0.0);
      return pdf > 0 ? radiance(glm::dvec3(d)) * cosine * pdf / (pdf * pdf + other * other) : 0;
    };
    const auto cosine_pdf = [&](glm::vec3 d) { return std::max(glm::dot(glm::dvec3(d), normal), 0.0) / kPi; };
    double sum = 0, sum2 = 0;
    constexpr int kPairs = 400000;
    for (int i = 0; i < kPairs; ++i) {
      const LightSample light = sample_light(scene, glm::vec3(0), uniform.pair(), uniform.pair(), facing);
      const glm::vec3 d = cosine_direction(uniform, normal);
      const double value = share(light.direction, light.pdf, cosine_pdf(light.direction)) +
                           share(d, cosine_pdf(d), environment_pdf(scene, d, facing));
      sum += value;
      sum2 += value * value;
    }
    const auto draw = [&] { return Draw{glm::vec3(random_direction(uniform))}; };
    const double expected = integral_over_sphere(
        draw, [&](glm::dvec3 d) { return radiance(d) * std::max(glm::dot(d, normal), 0.0); });
    const double mean = sum / kPairs;
    const double error = std::sqrt((sum2 / kPairs - mean * mean) / kPairs) + 1e-5 * expected;
    EXPECT_LT(std::fabs(mean - expected) / error, kMaxZ) << mean << " instead of " << expected;
    EXPECT_LT(6.1 * error, 1e-2 * expected);
  }
}

TEST(DeltaLights, PointFollowsTheInverseSquare) {
  const FlatScene scene = scene_with(make_emitter(KB_EMITTER_POINT, placed({3, 0, 4}, 0.3, glm::dvec3(1))));
  const LightSample sample = sample_light(scene, glm::vec3(0), {0, 0}, {0, 0});
  EXPECT_TRUE(sample.delta);
  EXPECT_FALSE(sample.infinite);
  EXPECT_EQ(sample.pdf, 1);
  EXPECT_FLOAT_EQ(sample.factor, 1 / 25.0f);
  EXPECT_FLOAT_EQ(sample.direction.x, 0.6f);
  EXPECT_FLOAT_EQ(sample.direction.z, 0.8f);
  EXPECT_EQ(sample.target, glm::vec3(3, 0, 4));
  EXPECT_EQ(sample_light(scene, {3, 0, 4}, {0, 0}, {0, 0}).pdf, 0);
}

TEST(DeltaLights, SpotFallsOffLinearlyInTheAngle) {
  // From 20 degrees down to a beam that a cosine in float cannot resolve.
  for (const double cutoff : {0.349, 1e-4}) {
    KbEmitter emitter = make_emitter(KB_EMITTER_SPOT);  // at the origin, along +Z
    emitter.cutoff_angle = static_cast<float>(cutoff);
    emitter.beam_width = static_cast<float>(0.75 * cutoff);
    const FlatScene scene = scene_with(emitter);
    for (int i = 0; i <= 60; ++i) {
      const double angle = cutoff * (i + 0.5) / 50;
      const glm::vec3 point(static_cast<float>(2 * std::sin(angle)), 0,
                            static_cast<float>(2 * std::cos(angle)));
      const double expected = std::clamp((cutoff - angle) / (0.25 * cutoff), 0.0, 1.0) / 4;
      const LightSample sample = sample_light(scene, point, {0, 0}, {0, 0});
      EXPECT_EQ(sample.pdf > 0, expected > 0);
      if (expected > 0) {
        EXPECT_NEAR(sample.factor, expected, 1e-5);
      }
    }
  }
}

TEST(DeltaLights, DirectionalComesFromBehindItsAxis) {
  const glm::dmat4 to_world = placed({5, 5, 5}, 1.2, glm::dvec3(3));
  const LightSample sample =
      sample_light(scene_with(make_emitter(KB_EMITTER_DIRECTIONAL, to_world)), {1, 2, 3}, {0, 0}, {0, 0});
  const glm::dvec3 axis = glm::normalize(glm::dvec3(to_world[2]));
  EXPECT_TRUE(sample.delta);
  EXPECT_TRUE(sample.infinite);
  EXPECT_EQ(sample.factor, 1);
  EXPECT_NEAR(glm::dot(glm::dvec3(sample.direction), axis), -1, 1e-6);
}

}  // namespace
}  // namespace kiloband::test::irradiance_test
