// Sampled directions of every kind of light against their densities.
//
// Each chi-square test draws 200 000 directions into some 400 cells: tests/support/chi_square.hpp says what it finds.
#include <gtest/gtest.h>

#include <functional>

#include "scene/compile/light/envmap_sampling.hpp"
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "test_scene.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::light_sampling_test {

using namespace cpu;
namespace {

constexpr int kSamples = 200000;

/// Tests sample_light() at `point` against density(direction); returns the density's integral.
double expect_distribution(const FlatScene& scene, glm::vec3 point,
                           const std::function<double(glm::dvec3)>& density, uint32_t seed,
                           uint32_t facing = KB_ALL_FACINGS) {
  Uniform uniform(seed);
  const auto draw = [&]() -> Draw {
    const glm::vec2 select = uniform.pair();
    const LightSample sample = sample_light(scene, point, select, uniform.pair(), facing);
    if (!(sample.pdf > 0 && density(glm::dvec3(sample.direction)) > 0)) return {};
    return {sample.direction};
  };
  const ChiSquare test = chi_square(draw, density, 0, kSamples, 4096);
  EXPECT_GT(test.p_value, kTestLevel) << "integral of the density: " << test.integral;
  return test.integral;
}

/// The same for the area light of shape 0, whose density needs a ray;
/// also compares both densities sample by sample.
double expect_area_light(const FlatScene& scene, glm::vec3 point, uint32_t seed, double min_cosine = 0) {
  const auto density = [&](glm::dvec3 direction) -> double {
    const Hit hit = trace(scene, point, direction);
    return hit.found ? area_light_pdf(scene, surface_at(scene, hit, point, direction), point) : 0;
  };
  Uniform uniform(seed + 1000);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec2 select = uniform.pair();
    const LightSample sample = sample_light(scene, point, select, uniform.pair());
    if (!(sample.pdf > 0)) continue;
    const glm::dvec3 direction(sample.direction);
    const Hit hit = trace(scene, point, direction);
    if (!hit.found) continue;  // rounded past an edge
    const glm::dvec3 at = glm::dvec3(point) + hit.t * direction;
    const glm::vec3 to_target = sample.target - glm::vec3(at);
    if (glm::length(to_target) > 1e-2f) continue;  // another part of the light in front
    // At grazing angles both are as uncertain as the cosine in 1 / pdf = area cos / distance^2.
    const double scale = scene.shapes[0].area / (hit.t * hit.t);
    EXPECT_NEAR(1 / density(direction), 1 / sample.pdf, 1e-4 / sample.pdf + 3e-5 * scale);
    EXPECT_EQ(sample.radiance.row, 3);
    EXPECT_NEAR(sample.factor, 1, 1e-5);  // triangles are chosen with whole steps of 2^-24
  }
  const auto away_from_silhouette = [&](glm::dvec3 direction) -> double {
    const Hit hit = trace(scene, point, direction);
    if (!hit.found) return 0;
    const SurfacePoint at = analytic_surface(scene.shapes[0], glm::dvec3(point) + hit.t * direction);
    return -glm::dot(glm::dvec3(at.normal), direction) > min_cosine ? density(direction) : 0;
  };
  if (min_cosine > 0) return expect_distribution(scene, point, away_from_silhouette, seed);
  return expect_distribution(scene, point, density, seed);
}

TEST(MeshLight, UnequalTriangles) {
  // Areas 6, 0.05, 0 (degenerate) and 1; all in one plane and visible.
  const FlatScene scene = scene_with_mesh({{0, 0, 2},
                                           {4, 0, 2},
                                           {0, 3, 2},
                                           {-1, 0, 2},
                                           {-1, 0.1f, 2},
                                           {-2, 0.1f, 2},
                                           {-1, -2, 2},
                                           {1, -2, 2},
                                           {1, -1, 2}},
                                          {0, 2, 1, 3, 5, 4, 0, 1, 1, 6, 8, 7});
  const double integral = expect_area_light(scene, {0.2f, 0.1f, 0}, 1);
  EXPECT_NEAR(integral, 1, 3e-3);
}

TEST(MeshLight, BackAndFlippedNormals) {
  const std::vector<KbFloat3> positions{{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}};
  const FlatScene away = scene_with_mesh(positions, {0, 1, 2, 0, 2, 3});
  EXPECT_EQ(sample_light(away, glm::vec3(0), {0.5f, 0.5f}, {0.3f, 0.7f}).pdf, 0);
  EXPECT_EQ(area_light_pdf(away, facing_hit({0, 0, 2}, {0, 0, 1}), glm::vec3(0)), 0);
  const FlatScene flipped = scene_with_mesh(positions, {0, 1, 2, 0, 2, 3}, KB_SHAPE_FLIP_NORMALS);
  const LightSample sample = sample_light(flipped, glm::vec3(0), {0.5f, 0.5f}, {0.3f, 0.7f});
  EXPECT_GT(sample.pdf, 0);
  EXPECT_LT(sample.target.z, 2);  // moved to the front
  EXPECT_GT(sample.target.z, 1.999f);
  // 2^2 / (4 * 1)
  EXPECT_NEAR(area_light_pdf(flipped, facing_hit({0, 0, 2}, {0, 0, -1}), glm::vec3(0)), 1, 1e-6);
}

// Tilted normals: parts of the mesh shine to a point, behind the winding too, and the density there is that
// of the area that is seen.
TEST(MeshLight, TiltedVertexNormals) {
  for (const bool winding_faces_point : {false, true}) {
    const float x = winding_faces_point ? -0.8f : 0.8f, z = winding_faces_point ? -0.6f : 0.6f;
    const FlatScene scene = quad_with_normals(winding_faces_point, x, z);
    const double integral = expect_area_light(scene, {0.9f, 0.2f, 1.5f}, 11);
    EXPECT_GT(integral, 0.1);
    EXPECT_LT(integral, 0.9);
  }
}

TEST(MeshLight, FoldedMeshIsHalfVisible) {
  // Two equal triangles back to back: half of the samples are behind.
  const FlatScene scene = scene_with_mesh({{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}, {0, 1, 2, 0, 2, 1});
  const auto density = [&](glm::dvec3 d) -> double {
    const Hit hit = trace(scene, glm::dvec3(0), d);
    return hit.found ? area_light_pdf(scene, facing_hit(glm::vec3(hit.t * d), {0, 0, -1}), glm::vec3(0)) : 0;
  };
  EXPECT_NEAR(expect_distribution(scene, glm::vec3(0), density, 2), 0.5, 3e-3);
}

TEST(SphereLight, Outside) {
  const FlatScene scene =
      scene_with_light(make_shape(KB_SHAPE_SPHERE, placed({1, 2, 3}, 0.7, glm::dvec3(0.5))));
  const glm::vec3 point(0.1f, -0.2f, 0.3f);
  const double integral = expect_area_light(scene, point, 3);
  EXPECT_NEAR(integral, 1, 3e-3);
}

TEST(SphereLight, NearlyTouching) {
  const FlatScene scene =
      scene_with_light(make_shape(KB_SHAPE_SPHERE, placed({0, 0, 0}, 0.7, glm::dvec3(2))));
  const glm::vec3 point(0, 0, 2.0002f);  // cone of 89.2 degrees
  EXPECT_NEAR(expect_area_light(scene, point, 4), 1, 3e-3);
}

TEST(SphereLight, InsideWithFlippedNormals) {
  const KbShape shape =
      make_shape(KB_SHAPE_SPHERE, placed({1, 0, 0}, 0.7, glm::dvec3(2)), KB_SHAPE_FLIP_NORMALS);
  const FlatScene scene = scene_with_light(shape);
  EXPECT_NEAR(expect_area_light(scene, {2, 0.5f, 0.3f}, 5), 1, 3e-3);
  EXPECT_EQ(sample_light(scene, {5, 0, 0}, {0, 0}, {0.5f, 0.5f}).pdf, 0);  // from outside: backs
}

TEST(SphereLight, BackSides) {
  const FlatScene scene = scene_with_light(make_shape(KB_SHAPE_SPHERE, identity()));
  EXPECT_EQ(sample_light(scene, glm::vec3(0.2f), {0, 0}, {0.5f, 0.5f}).pdf, 0);
  EXPECT_EQ(area_light_pdf(scene, facing_hit({1, 0, 0}, {1, 0, 0}), glm::vec3(0.2f)), 0);
  EXPECT_GT(area_light_pdf(scene, facing_hit({1, 0, 0}, {1, 0, 0}), {3, 0, 0}), 0);
  EXPECT_EQ(area_light_pdf(scene, facing_hit({-1, 0, 0}, {-1, 0, 0}), {3, 0, 0}), 0);  // the far side
}

TEST(SphereLight, TinyAndFar) {
  // Half angles of 5e-7 and 1e-9: the density is 1 / (pi sin^2), and targets lie on the sphere's near side.
  for (const double radius : {1e-2, 2e-5}) {
    const FlatScene scene =
        scene_with_light(make_shape(KB_SHAPE_SPHERE, placed({0, 0, 2e4}, 0, glm::dvec3(radius))));
    const LightSample sample = sample_light(scene, glm::vec3(0), {0, 0}, {0.9f, 0.3f});
    const double sine = static_cast<float>(radius) / 2e4;
    EXPECT_NEAR(sample.pdf * sine * sine * 3.14159265358979, 1, 1e-5);
    EXPECT_NEAR(sample.direction.z, 1, 1e-6);
    EXPECT_LE(sample.target.z, 2e4);
  }
}

TEST(DiskLight, TiltedEllipse) {
  const FlatScene scene = scene_with_light(make_shape(KB_SHAPE_DISK, placed({0, 0, 3}, 2.6, {1.5, 0.7, 1})));
  const glm::vec3 normal = analytic_surface(scene.shapes[0], {0, 0, 3}).normal;
  const glm::vec3 point = glm::vec3(0, 0, 3) + 2.0f * normal + glm::vec3(0.3f, 0.1f, 0);
  EXPECT_NEAR(expect_area_light(scene, point, 6), 1, 3e-3);
}

TEST(CylinderLight, OutsideSeesItsNearHalf) {
  const FlatScene scene =
      scene_with_light(make_shape(KB_SHAPE_CYLINDER, placed({0, 0, 0}, 0.4, {0.5, 0.5, 2})));
  const glm::vec3 point(3, 0.5f, 0.2f);
  expect_area_light(scene, point, 7, 0.2);
  // The front of the wall is seen where the normal is within acos(r / distance from the axis) of the point: a
  // binomial count of 200 000 finds a deviation of 0.7 % of the area.
  const glm::dvec3 axis = glm::normalize(
      glm::dvec3(scene.shapes[0].to_world[2], scene.shapes[0].to_world[6], scene.shapes[0].to_world[10]));
  const double p = std::acos(0.5 / glm::length(glm::cross(axis, glm::dvec3(point)))) / 3.14159265358979;
  Uniform uniform(70);
  int seen = 0;
  for (int i = 0; i < kSamples; ++i) seen += sample_light(scene, point, {0, 0}, uniform.pair()).pdf > 0;
  EXPECT_LT(std::fabs(seen - p * kSamples) / std::sqrt(p * (1 - p) * kSamples), kMaxZ);
}

TEST(CylinderLight, InsideWithFlippedNormals) {
  const KbShape shape =
      make_shape(KB_SHAPE_CYLINDER, placed({0, 0, -1}, 0, {1, 1, 2}), KB_SHAPE_FLIP_NORMALS);
  const FlatScene scene = scene_with_light(shape);
  EXPECT_NEAR(expect_area_light(scene, {0.2f, 0.3f, 0.1f}, 8), 1, 3e-3);
}

TEST(ConstantEnvironment, Uniform) {
  const FlatScene scene = scene_with(make_emitter(KB_EMITTER_CONSTANT));
  const auto density = [&](glm::dvec3 d) { return environment_pdf(scene, glm::vec3(d)); };
  EXPECT_NEAR(expect_distribution(scene, glm::vec3(0), density, 9), 1, 1e-5);
  EXPECT_TRUE(sample_light(scene, glm::vec3(0), {0, 0}, {0.5f, 0.5f}).infinite);
}

TEST(Environment, MapWithBrightTexelRotated) {
  std::vector<float> texels(16 * 9, 0.2f);
  texels[3 * 16 + 15] = 30;  // its patches reach over the seam
  texels[0 * 16 + 4] = 5;    // at a pole
  double mean = 0;
  const std::vector<double> row_weights = row_solid_angles(9);
  for (uint32_t i = 0; i < texels.size(); ++i)
    mean += texels[i] * row_weights[i / 16] / static_cast<double>(texels.size());
  const FlatScene scene = envmap_scene(16, 9, texels, placed({7, 8, 9}, 1.1, glm::dvec3(1)));
  const auto density = [&](glm::dvec3 d) { return environment_pdf(scene, glm::vec3(d)); };
  EXPECT_NEAR(expect_distribution(scene, glm::vec3(0), density, 10), 1, 2e-3);
  Uniform uniform(11);
  for (int i = 0; i < 2000; ++i) {
    const LightSample sample = sample_light(scene, glm::vec3(0), {0, 0}, uniform.pair());
    EXPECT_EQ(sample.pdf, environment_pdf(scene, sample.direction));
    const float radiance = bitmap_value(scene, sample.radiance.texture);
    EXPECT_EQ(radiance, bitmap_value(scene, environment_radiance(scene, sample.direction).texture));
    // Bounded weights: where the map is not above its mean by the uniform share; elsewhere a cell's interpolated radiance is at most 6 times
    // its weighted mean, half of which lies above the map's.
    const double bound = radiance < mean ? 1.001 * radiance / kEnvmapUniformShare : 12.2 * mean;
    EXPECT_LT(radiance / sample.pdf, 4 * 3.1416 * bound);
  }
}

/// For receivers of one facing: what they do not see is never sampled, and has density 0.
TEST(Environment, DirectionsForAFacing) {
  std::vector<float> texels(64 * 33, 0.2f);
  texels[12 * 64 + 63] = 30;
  texels[27 * 64 + 20] = 10;
  const FlatScene scene = envmap_scene(64, 33, texels, placed({7, 8, 9}, 1.1, glm::dvec3(1)));
  for (const uint32_t facing : {0u, 20u, 35u, 63u}) {
    const auto density = [&](glm::dvec3 d) { return environment_pdf(scene, glm::vec3(d), facing); };
    EXPECT_NEAR(expect_distribution(scene, glm::vec3(0), density, 12 + facing, facing), 1, 5e-3) << facing;
    Uniform uniform(facing);
    int unseen = 0;
    for (int i = 0; i < 2000; ++i) {
      const LightSample sample = sample_light(scene, glm::vec3(0), uniform.pair(), uniform.pair(), facing);
      EXPECT_EQ(sample.pdf, environment_pdf(scene, sample.direction, facing));
      EXPECT_GT(sample.pdf, 0);
      unseen += density(random_direction(uniform)) == 0;
    }
    EXPECT_GT(unseen, 500) << facing;  // of 2000 directions a third lies far below the horizon
  }
}

TEST(Selection, FollowsTheTable) {
  // Point lights chosen with probability 0.5, 0, 0.2 and 0.3; N = 100 000, 2 degrees of freedom: a change of
  // 0.01 of any probability is found with probability > 0.99.
  FlatScene scene;
  const float pdfs[] = {0.5f, 0, 0.2f, 0.3f};
  for (int i = 0; i < 4; ++i) {
    scene.emitters.push_back(make_emitter(KB_EMITTER_POINT, placed({i, 0, 2}, 0, glm::dvec3(1))));
    scene.emitters[i].select_pdf = pdfs[i];
    scene.emitters[i].ref = i;
  }
  scene.emitter_cdf = {0, 0.5f, 0.5f, 0.7f, 1};
  std::vector<double> observed(4), expected;
  Uniform uniform(12);
  for (int i = 0; i < 100000; ++i) {
    const LightSample sample = sample_light(scene, glm::vec3(0), uniform.pair(), {0, 0});
    EXPECT_EQ(sample.pdf, pdfs[sample.radiance.row]);
    ++observed[sample.radiance.row];
  }
  for (const float p : pdfs) expected.push_back(1e5 * p);
  EXPECT_GT(chi_square(observed, expected).p_value, kTestLevel);
}

}  // namespace
}  // namespace kiloband::test::light_sampling_test
