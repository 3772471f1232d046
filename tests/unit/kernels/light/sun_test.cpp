// Suns on the device against src_cpu/light/sun-inl.hpp: samples, densities, what escaping rays meet.
#include "support.hpp"
#include "tests/support/one_path_lights.hpp"
#include "tests/unit/src_cpu/light/test_scene.hpp"

namespace kiloband::test::sun_test {

using namespace cpu;
namespace {

const char* const kSource = R"(
#include "light/emitter.clh"
__kernel void sample_sun_of_scene(ARGS) {
  ITEM
  const LightSample s = sample_light(&scene, (float3)(0.0f), KB_ALL_FACINGS, (float2)(0.5f), VEC2(0));
  PUT3(0, s.direction); out->f[3] = s.pdf; out->f[4] = s.factor;
  out->u[0] = (s.infinite ? 1u : 0u) | (s.delta ? 2u : 0u) | (s.radiance.textured ? 4u : 0u);
  out->u[1] = s.radiance.row;
}
__kernel void look(ARGS) {
  ITEM
  out->u[0] = meets_sun(&scene.emitters[0], VEC3(0)) ? 1u : 0u;
  out->f[0] = sun_density(&scene.emitters[0]);
}
)";

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + kSource);
  return instance;
}

FlatScene scene_of(double radius, const glm::dmat4& to_world) {
  KbEmitter sun = make_sun(radius, to_world);
  sun.ref = 4;
  sun.select_pdf = 0.25f;
  return scene_with(sun);
}

/// The azimuth 2 pi u is rounded to 2.4e-7 rad there, and not here: that moves a direction by sin r times as much. What is left is
/// the rounding of unit vectors.
TEST(GpuSuns, SamplesAndDensities) {
  for (const double radius : {2e-5, 4.65e-3, 0.3, 1.57}) {
    SCOPED_TRACE(radius);
    const FlatScene scene = scene_of(radius, placed({7, 8, 9}, 1.1, glm::dvec3(1)));
    Random random(41);
    std::vector<ItemIn> in(20000);
    for (ItemIn& item : in) item = {{random.unit(), random.unit()}, {}};
    in[0] = {{0, 0}, {}};
    const std::vector<ItemOut> out = run_items(probe(), "sample_sun_of_scene", scene, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const LightSample expected = sample_light(scene, glm::vec3(0), {0.5f, 0.5f}, get2(in[i], 0));
      ASSERT_LT(difference(get3(out[i], 0), expected.direction), 2.5e-7 + 5e-7 * std::sin(radius));
      ASSERT_LT(relative(out[i].f[3], expected.pdf), 4e-7);
      ASSERT_EQ(out[i].f[4], expected.factor);
      ASSERT_EQ(out[i].u[0], 1u);
      ASSERT_EQ(out[i].u[1], 4u);
    }
  }
}

/// The same answer for every direction that is not within rounding of the edge.
TEST(GpuSuns, EscapingRays) {
  for (const double radius : {2e-5, 4.65e-3, 0.3, 1.57}) {
    SCOPED_TRACE(radius);
    const glm::dmat4 to_world = placed({0, 0, 0}, 0.7, glm::dvec3(1));
    const FlatScene scene = scene_of(radius, to_world);
    const glm::dvec3 axis = -glm::dvec3(to_world[2]);
    Random random(42);
    std::vector<ItemIn> in(20000);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const glm::dvec3 aside = glm::normalize(glm::cross(axis, random.direction()));
      const double angle = i % 2 ? radius * 2 * random.unit() : radius + 1e-6 * (random.unit() - 0.5);
      put(in[i], 0, glm::vec3(std::cos(angle) * axis + std::sin(angle) * aside));
    }
    const std::vector<ItemOut> out = run_items(probe(), "look", scene, in);
    std::size_t met = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const float expected = sun_pdf(scene, 0, get3(in[i], 0));
      met += expected > 0;
      if (expected > 0) {
        ASSERT_LT(relative(out[i].f[0], expected), 4e-7);
      }
      const glm::dvec3 off = glm::normalize(glm::dvec3(get3(in[i], 0))) - axis;
      const double angle = 2 * std::asin(0.5 * glm::length(off));
      if (std::fabs(angle - radius) > 3e-7) {
        ASSERT_EQ(out[i].u[0] != 0, expected > 0) << angle;
      }
    }
    EXPECT_GT(met, in.size() / 3);
    EXPECT_LT(met, in.size() - in.size() / 10);
  }
}

}  // namespace
}  // namespace kiloband::test::sun_test
