// Environments on the device against src_cpu/light/environment-inl.hpp: coordinates, densities,
// poles and the seam.
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "support.hpp"
#include "tests/support/one_path_lights.hpp"
#include "tests/unit/src_cpu/light/test_scene.hpp"

namespace kiloband::test::environment_test {

using namespace cpu;
namespace {

const char* const kSource = R"(
#include "light/emitter.clh"
__kernel void sample_map(ARGS) {
  ITEM
  const LightSample s = sample_light(&scene, (float3)(0.0f), in->u[0], (float2)(0.5f, in->f[2]), VEC2(0));
  PUT3(0, s.direction); out->f[3] = s.pdf; out->f[4] = s.factor;
  out->f[5] = environment_pdf(&scene, s.direction, in->u[0]);
  out->f[6] = s.radiance.texture.fx; out->f[7] = s.radiance.texture.fy;
  out->u[0] = (s.infinite ? 1u : 0u) | (s.delta ? 2u : 0u) | (s.radiance.textured ? 4u : 0u);
  out->u[1] = s.radiance.row; out->u[2] = s.radiance.texture.xy;
}
__kernel void look(ARGS) {
  ITEM
  const float2 uv = envmap_coordinates(&scene.emitters[0], VEC3(0));
  const ResolvedSpectrum r = environment_radiance(&scene, VEC3(0));
  out->f[0] = uv.x; out->f[1] = uv.y; out->f[2] = environment_pdf(&scene, VEC3(0), in->u[0]);
  out->f[3] = r.textured ? bitmap_value(&scene, &r.texture) : 0.0f;
  out->u[0] = r.textured; out->u[1] = r.row; out->u[2] = facing_of(&scene.emitters[0], VEC3(0));
}
)";

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + kSource);
  return instance;
}

/// Texels at random, one in fifty far brighter than the others.
FlatScene random_envmap(uint32_t width, uint32_t height, const glm::dmat4& to_world, uint32_t seed) {
  Random random(seed);
  std::vector<float> texels;
  for (uint32_t i = 0; i < width * height; ++i)
    texels.push_back(random.index(50) == 0 ? 1000 * random.unit() : random.unit());
  return envmap_scene(width, height, texels, to_world);
}

const uint32_t kSizes[][2] = {{16, 9}, {3, 2}, {1024, 513}, {2, 2}};

/// Samples: the same cell, so the direction agrees to float precision. The density is the cell's: next to a
/// cell's border rounding of the direction may name the neighbour.
TEST(GpuEnvironment, SamplesOfMaps) {
  for (const auto& size : kSizes) {
    const FlatScene scene = random_envmap(size[0], size[1], placed({7, 8, 9}, 1.1, glm::dvec3(2)), size[0]);
    Random random(25);
    std::vector<ItemIn> in(30000);
    for (ItemIn& item : in)
      item = {{random.unit(), random.unit(), random.unit()}, {random.index(KB_FACINGS + 1)}};
    in[0] = {{0, 0, 0}, {0}};
    in[1] = {{KB_ONE_MINUS_EPSILON, KB_ONE_MINUS_EPSILON, KB_ONE_MINUS_EPSILON}, {KB_ALL_FACINGS}};
    const std::vector<ItemOut> out = run_items(probe(), "sample_map", scene, in);
    std::size_t other_cell = 0, other_texel = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const LightSample expected =
          sample_light(scene, glm::vec3(0), {0.5f, in[i].f[2]}, get2(in[i], 0), in[i].u[0]);
      ASSERT_EQ(out[i].u[0], 5u);
      ASSERT_EQ(out[i].f[4], 1);
      ASSERT_LT(difference(get3(out[i], 0), expected.direction), 2e-6) << i;
      ASSERT_EQ(out[i].f[3], out[i].f[5]) << i;  // what a ray finds in the same direction
      ASSERT_GT(out[i].f[3], 0) << i;
      if (relative(out[i].f[3], expected.pdf) > 1e-5) ++other_cell;
      if (out[i].u[2] != expected.radiance.texture.xy) {
        ++other_texel;
        continue;
      }
      const double tolerance =
          1e-6 * size[0] /
          std::sqrt(1 - std::pow(std::fmin(std::fabs(glm::dot(glm::dvec3(expected.direction),
                                                              glm::normalize(glm::dvec3(placed(
                                                                  {0, 0, 0}, 1.1, glm::dvec3(1))[1])))),
                                           1 - 1e-9),
                                 2));
      ASSERT_NEAR(out[i].f[6], expected.radiance.texture.fx, tolerance + 1e-5) << i;
      ASSERT_NEAR(out[i].f[7], expected.radiance.texture.fy, 1e-6 * size[1] + 1e-5) << i;
    }
    // A cell of the widest map is 6e-3 wide: 4 borders times 3e-7 of it.
    EXPECT_LE(other_cell, 20u) << size[0];
    EXPECT_LE(other_texel, 20u) << size[0];
  }
}

/// Coordinates, density and radiance of directions, poles and the seam among them.
TEST(GpuEnvironment, DirectionsPolesAndSeam) {
  for (const auto& size : kSizes) {
    for (const double angle : {0.0, 2.0}) {
      const FlatScene scene =
          random_envmap(size[0], size[1], placed({0, 0, 0}, angle, glm::dvec3(1)), size[1]);
      Random random(26);
      std::vector<ItemIn> in(20000);
      for (std::size_t i = 0; i < in.size(); ++i) {
        glm::dvec3 d = random.direction();
        if (i % 4 == 1) d = {1e-4 * d.x, d.y < 0 ? -1 : 1, 1e-4 * d.z};                       // near a pole
        if (i % 4 == 2) d = {(d.x < 0 ? -1e-6 : 1e-6) * (i % 8 == 2), d.y, -std::fabs(d.z)};  // at the seam
        put(in[i], 0, glm::vec3(glm::normalize(d)));
        in[i].u[0] = random.index(KB_FACINGS + 1);
      }
      put(in[0], 0, {0, 1, 0});
      put(in[1], 0, {0, -1, 0});
      const std::vector<ItemOut> out = run_items(probe(), "look", scene, in);
      std::size_t other_cell = 0, other_facing = 0;
      for (std::size_t i = 0; i < in.size(); ++i) {
        const glm::vec3 d = get3(in[i], 0);
        other_facing += out[i].u[2] != environment_facing(scene.emitters[0], d);
        const glm::vec2 uv = envmap_coordinates(scene.emitters[0], d);
        const float pdf = environment_pdf(scene, d, in[i].u[0]);
        ASSERT_TRUE(out[i].f[0] >= 0 && out[i].f[0] < 1 && out[i].f[1] >= 0 && out[i].f[1] <= 1) << i;
        ASSERT_NEAR(out[i].f[1], uv.y, 5e-7) << i;
        const double from_pole = std::sin(3.141592653589793 * uv.y);
        if (from_pole > 1e-5) {
          ASSERT_LT(periodic(out[i].f[0], uv.x), 2e-7 + 1e-7 / from_pole) << i;
        }
        if (out[i].f[2] != pdf && relative(out[i].f[2], pdf) > 1e-5) ++other_cell;
        ASSERT_EQ(out[i].u[0], 1u);
        const float radiance = bitmap_value(scene, environment_radiance(scene, d).texture);
        if (from_pole > 1e-3) {
          // Neighbouring texels differ by up to 1000: the coordinate's error in texels times that.
          ASSERT_NEAR(out[i].f[3], radiance, 1000 * size[0] * (2e-7 + 1e-7 / from_pole) + 1e-5 * radiance)
              << i;
        }
      }
      EXPECT_LE(other_cell, in.size() / 200) << size[0];
      EXPECT_LE(other_facing, in.size() / 200) << size[0];
    }
  }
}

TEST(GpuEnvironment, Constant) {
  KbEmitter emitter = make_emitter(KB_EMITTER_CONSTANT);
  emitter.ref = 4;
  emitter.select_pdf = 0.25f;
  FlatScene scene = scene_with(emitter);
  Random random(27);
  std::vector<ItemIn> in(10000);
  for (ItemIn& item : in) item = {{random.unit(), random.unit(), random.unit()}, {KB_ALL_FACINGS}};
  const std::vector<ItemOut> out = run_items(probe(), "sample_map", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const LightSample expected = sample_light(scene, glm::vec3(0), {0.5f, 0.5f}, get2(in[i], 0));
    ASSERT_LT(difference(get3(out[i], 0), expected.direction), 1e-6);
    ASSERT_EQ(out[i].f[3], expected.pdf);
    ASSERT_EQ(out[i].f[5], environment_pdf(scene, expected.direction));
    ASSERT_EQ(out[i].u[0], 1u);
    ASSERT_EQ(out[i].u[1], 4u);
  }
  const std::vector<ItemOut> look = run_items(probe(), "look", scene, in);
  EXPECT_EQ(look[0].u[0], 0u);
  EXPECT_EQ(look[0].u[1], 4u);
}

}  // namespace
}  // namespace kiloband::test::environment_test
