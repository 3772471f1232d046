// Light selection, sampling and densities on the device against src_cpu/light/light-inl.hpp and area.cpp,
// which treats spheres in double.
#include "scene/compile/light/lattice_cdf.hpp"
#include "src_cpu/light/area.hpp"
#include "support.hpp"
#include "tests/support/one_path_lights.hpp"
#include "tests/unit/src_cpu/light/test_scene.hpp"

namespace kiloband::test::emitter_test {

using namespace cpu;
namespace {

const char* const kSource = R"(
#include "light/emitter.clh"
__kernel void light(ARGS) {
  ITEM
  const LightSample s = sample_light(&scene, VEC3(0), KB_ALL_FACINGS, VEC2(3), VEC2(5));
  PUT3(0, s.direction); PUT3(3, s.target); out->f[6] = s.pdf; out->f[7] = s.factor;
  out->f[8] = s.radiance.texture.fx; out->f[9] = s.radiance.texture.fy;
  out->u[0] = (s.infinite ? 1u : 0u) | (s.delta ? 2u : 0u) | (s.radiance.textured ? 4u : 0u);
  out->u[1] = s.radiance.row; out->u[2] = s.radiance.texture.xy; out->u[3] = s.radiance.texture.texture;
}
__kernel void density(ARGS) {
  ITEM
  SurfaceHit hit;
  hit.shape = in->u[0]; hit.point = VEC3(3); hit.geometric_normal = VEC3(6); hit.shading_normal = VEC3(12);
  out->f[0] = area_light_pdf(&scene, &hit, VEC3(0));
  out->f[1] = environment_pdf(&scene, VEC3(9), KB_ALL_FACINGS);
}
)";

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + kSource);
  return instance;
}

LightSample cpu_sample(const FlatScene& scene, const ItemIn& item) {
  return sample_light(scene, get3(item, 0), get2(item, 3), get2(item, 5));
}

uint32_t flags_of(const LightSample& s) {
  return (s.infinite ? 1u : 0u) | (s.delta ? 2u : 0u) | (s.radiance.textured ? 4u : 0u);
}

/// Points at `distance` (times a number of 0 to 1, squared) from the centre.
std::vector<ItemIn> points_around(glm::dvec3 centre, double distance, std::size_t count, uint32_t seed) {
  Random random(seed);
  std::vector<ItemIn> in(count);
  for (ItemIn& item : in) {
    const double part = random.unit();
    put(item, 0, glm::vec3(centre + random.direction() * (distance * part * part)));
    for (int i = 3; i < 7; ++i) item.f[i] = random.unit();
  }
  return in;
}

/// How much rounding of positions, 5e-7 here, may move the density of sampling over an area: it goes with
/// 1 / (distance from the light's plane) and the distance cubed.
double conditioning(const FlatScene& scene, const ItemIn& item) {
  const AreaLightSample sample =
      sample_area_light(scene, scene.shapes[0], {item.f[4], KB_NONE, 0}, get3(item, 0), get2(item, 5), false);
  const glm::dvec3 way = glm::dvec3(sample.position) - glm::dvec3(get3(item, 0));
  return 5e-7 / std::fabs(glm::dot(way, glm::dvec3(sample.normal))) + 2e-6 / glm::length(way);
}

struct Tolerance {
  double direction = 2e-6, target = 4e-6, pdf = 2e-5;
  std::size_t parted = 2;  // samples that only one of the two has: grazing ones
  bool by_area = false;    // the density's conditioning is that of conditioning()
};

/// Every sample against the CPU's; then the densities of the directions that were found.
void expect_samples(const FlatScene& scene, const std::vector<ItemIn>& in, const Tolerance& tolerance) {
  const std::vector<ItemOut> out = run_items(probe(), "light", scene, in);
  std::size_t parted = 0, lit = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const LightSample expected = cpu_sample(scene, in[i]);
    if ((expected.pdf > 0) != (out[i].f[6] > 0)) {
      ++parted;
      continue;
    }
    ASSERT_EQ(out[i].u[0], flags_of(expected)) << i;
    ASSERT_EQ(out[i].u[1], expected.radiance.row) << i;
    if (!(expected.pdf > 0)) continue;
    ++lit;
    const double more = tolerance.by_area ? conditioning(scene, in[i]) : 0;
    ASSERT_LT(difference(get3(out[i], 0), expected.direction), tolerance.direction + more) << i;
    ASSERT_LT(difference(get3(out[i], 3), expected.target), tolerance.target) << i;
    ASSERT_LT(relative(out[i].f[6], expected.pdf), tolerance.pdf + more) << i << " " << expected.pdf;
    ASSERT_LT(relative(out[i].f[7], expected.factor), 2e-5) << i;
  }
  EXPECT_GT(lit, in.size() / 100);
  EXPECT_LE(parted, tolerance.parted);
}

/// area_light_pdf() of the sampled points, moved off the light as targets are.
void expect_densities(const FlatScene& scene, const std::vector<ItemIn>& points, const Tolerance& tolerance) {
  std::vector<ItemIn> in;
  for (const ItemIn& point : points) {
    const LightSample sample = cpu_sample(scene, point);
    if (!(sample.pdf > 0)) continue;
    ItemIn item = point;
    const KbShape& shape = scene.shapes[0];
    const bool mesh = shape.type == KB_SHAPE_MESH;
    put(item, 3, sample.target);
    put(item, 6, mesh ? -sample.direction : analytic_surface(shape, glm::dvec3(sample.target)).normal);
    put(item, 12, get3(item, 6));
    item.u[0] = 0;
    in.push_back(item);
  }
  const std::vector<ItemOut> out = run_items(probe(), "density", scene, in);
  std::size_t parted = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const float expected = area_light_pdf(scene, facing_hit(get3(in[i], 3), get3(in[i], 6)), get3(in[i], 0));
    if ((expected > 0) != (out[i].f[0] > 0)) {
      ++parted;
      continue;
    }
    // The normal's rounding, over the cosine.
    const double way = glm::length(glm::dvec3(get3(in[i], 3)) - glm::dvec3(get3(in[i], 0)));
    const double cosine = way * way / (double{expected} * scene.shapes[0].area);
    const double more = tolerance.by_area ? 5e-7 / cosine : 0;
    ASSERT_LT(relative(out[i].f[0], expected), tolerance.pdf + more) << i;
  }
  EXPECT_LE(parted, in.size() / 10000 + 2);
}

/// Off-surface targets of a float sphere: the position's rounding moves targets by up
/// to one step of 256 units.
double step(double coordinate) {
  return 1.5e-5 + 256 * 1.2e-7 * coordinate;
}

TEST(GpuLights, SpheresFromOutsideAndInside) {
  for (const uint32_t flags : {0u, KB_SHAPE_FLIP_NORMALS}) {
    for (const double size : {0.01, 1.0, 100.0}) {
      const glm::dvec3 centre = glm::dvec3(1, 2, -1) * size;
      const FlatScene scene =
          scene_with_light(make_shape(KB_SHAPE_SPHERE, placed(centre, 0.7, glm::dvec3(size)), flags));
      const std::vector<ItemIn> in = points_around(centre, 5 * size, 40000, 15);
      // Next to the sphere the direction to a point of it turns with the rounding of its position.
      expect_samples(scene, in, {3e-5, 1e-5 * size + step(0) / 30, 2e-4, 8});
      expect_densities(scene, in, {0, 0, 2e-4});
    }
  }
}

/// Radius and distance differ by 1e4 and by 1e8: only the cone is left, and keeps its digits.
TEST(GpuLights, FarSpheres) {
  for (const double radius : {1.0, 1e-4}) {
    const FlatScene scene =
        scene_with_light(make_shape(KB_SHAPE_SPHERE, placed({0, 0, 2e4}, 0, glm::dvec3(radius))));
    const std::vector<ItemIn> in = points_around({0, 0, 0}, 100, 20000, 16);
    expect_samples(scene, in, {3e-7, 1e-2, 2e-6, 0});
    expect_densities(scene, in, {0, 0, 2e-6});
  }
}

TEST(GpuLights, DisksAndCylinders) {
  for (const uint32_t flags : {0u, KB_SHAPE_FLIP_NORMALS}) {
    for (const double mirror : {1.0, -1.0}) {
      const FlatScene disk =
          scene_with_light(make_shape(KB_SHAPE_DISK, placed({0, 1, 3}, 2.6, {1.5 * mirror, 0.7, 1}), flags));
      const FlatScene cylinder = scene_with_light(
          make_shape(KB_SHAPE_CYLINDER, placed({0, 1, 3}, 0.4, {0.5 * mirror, 0.5, 2}), flags));
      const std::vector<ItemIn> in = points_around({0, 1, 3}, 5, 40000, 17);
      expect_samples(disk, in, {2e-6, 2e-6, 2e-6, 2, true});
      expect_samples(cylinder, in, {2e-6, 2e-6, 2e-6, 2, true});
      expect_densities(disk, in, {0, 0, 2e-6, 2, true});
      expect_densities(cylinder, in, {0, 0, 2e-6, 2, true});
    }
  }
}

/// Meshes with uvs, a bitmap on them, normals all over the place,
/// triangles of very different areas and a sliver.
FlatScene mesh_light(uint32_t flags) {
  FlatScene scene = scene_with_mesh({{0, 0, 0},
                                     {1, 0, 0},
                                     {0, 1, 0.2f},
                                     {1, 1, 0},
                                     {1e-3f, 1e-3f, 2},
                                     {2e-3f, 1e-3f, 2},
                                     {1e-3f, 3e-3f, 2.001f},
                                     {3, 3, 1},
                                     {4, 4.00001f, 1}},
                                    {0, 1, 2, 1, 3, 2, 4, 5, 6, 3, 7, 8}, flags);
  Random random(18);
  std::vector<double> areas;
  for (std::size_t i = 1; i < scene.area_cdf.size(); ++i)
    areas.push_back(double{scene.area_cdf[i]} - double{scene.area_cdf[i - 1]});
  scene.area_cdf = lattice_cdf(areas);
  for (std::size_t i = 0; i < scene.positions.size(); ++i) {
    scene.uvs.push_back({random.unit(), random.unit()});
    const glm::vec3 n(random.direction());
    scene.normals.push_back({n.x, n.y, n.z});
  }
  scene.textures.push_back({16, 8, 0, KB_WRAP_REPEAT, 0, KB_NONE, {1, 0, 0, 0, 1, 0}});
  scene.texels.assign(128, {0, 0, 1e10f, 1});
  if (flags & KB_SHAPE_HAS_UVS) scene.emitters[0].ref = KB_REF_BITMAP;
  return scene;
}

TEST(GpuLights, MeshesAndTheirTextures) {
  for (const uint32_t flags :
       {0u, KB_SHAPE_FLIP_NORMALS, KB_SHAPE_HAS_UVS, KB_SHAPE_HAS_UVS | KB_SHAPE_FLIP_NORMALS,
        KB_SHAPE_HAS_NORMALS, KB_SHAPE_HAS_NORMALS | KB_SHAPE_FLIP_NORMALS, uint32_t{KB_SHAPE_MIRRORED}}) {
    const FlatScene scene = mesh_light(flags);
    const std::vector<ItemIn> in = points_around({0.5, 0.5, 0}, 6, 40000, 19);
    expect_samples(scene, in, {2e-6, 2e-6, 2e-6, 2, true});
    expect_densities(scene, in, {0, 0, 2e-6, 2, true});
    const std::vector<ItemOut> out = run_items(probe(), "light", scene, in);
    std::size_t other = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const LightSample expected = cpu_sample(scene, in[i]);
      if (!expected.radiance.textured || out[i].f[6] == 0) continue;
      if (out[i].u[2] != expected.radiance.texture.xy) {
        ++other;
        continue;
      }
      ASSERT_NEAR(out[i].f[8], expected.radiance.texture.fx, 1e-5);
      ASSERT_NEAR(out[i].f[9], expected.radiance.texture.fy, 1e-5);
    }
    EXPECT_LE(other, 4u);
  }
}

TEST(GpuLights, PointsSpotsAndDirections) {
  for (const uint32_t type : {KB_EMITTER_POINT, KB_EMITTER_SPOT, KB_EMITTER_DIRECTIONAL}) {
    KbEmitter emitter = make_emitter(type, placed({1, 2, 3}, 0.9, glm::dvec3(2)));
    emitter.ref = 5;
    emitter.cutoff_angle = 1.2f;
    emitter.beam_width = 0.6f;
    const FlatScene scene = scene_with(emitter);
    std::vector<ItemIn> in = points_around({1, 2, 3}, 10, 20000, 20);
    put(in[0], 0, {1, 2, 3});  // the light itself
    // The falloff is linear in the angle: relative errors grow towards the cutoff.
    const std::vector<ItemOut> out = run_items(probe(), "light", scene, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const LightSample expected = cpu_sample(scene, in[i]);
      ASSERT_EQ(out[i].u[0], flags_of(expected));
      ASSERT_LT(difference(get3(out[i], 0), expected.direction), 1e-6);
      ASSERT_EQ(get3(out[i], 3), expected.target);
      const double inverse = 1 / std::pow(glm::length(glm::dvec3(get3(in[i], 0)) - glm::dvec3(1, 2, 3)), 2.0);
      const double scale = type == KB_EMITTER_DIRECTIONAL ? 1 : inverse;
      ASSERT_LE(std::fabs(out[i].f[7] - expected.factor), i == 0 ? 0 : 2e-6 * scale) << i;
      ASSERT_EQ(out[i].f[6] > 0, expected.pdf > 0) << i;
    }
  }
}

/// Many emitters, some next to never chosen: the same choice for every random number,
/// of the same probability.
TEST(GpuLights, SelectionIsExact) {
  FlatScene scene;
  Random random(21);
  std::vector<double> weights;
  for (uint32_t i = 0; i < 100; ++i) {
    scene.emitters.push_back(
        make_emitter(i % 3 ? KB_EMITTER_POINT : KB_EMITTER_DIRECTIONAL, placed({i, 0, 2}, i, glm::dvec3(1))));
    scene.emitters.back().ref = i;
    weights.push_back(i % 7 == 0 ? 1e-12 : random.unit());
  }
  scene.emitter_cdf = lattice_cdf(weights);
  for (std::size_t i = 0; i < 100; ++i)
    scene.emitters[i].select_pdf = scene.emitter_cdf[i + 1] - scene.emitter_cdf[i];
  std::vector<ItemIn> in = points_around({0, 5, 0}, 10, 20000, 22);
  for (std::size_t i = 0; i < 202; ++i) {  // the table's own values and the numbers before them
    const float edge = scene.emitter_cdf[i / 2] - (i % 2 ? 0x1p-24f : 0);
    in[i].f[3] = std::fmin(std::fmax(edge, 0.0f), KB_ONE_MINUS_EPSILON);
  }
  const std::vector<ItemOut> out = run_items(probe(), "light", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const LightSample expected = cpu_sample(scene, in[i]);
    ASSERT_EQ(out[i].u[1], expected.radiance.row) << in[i].f[3];
    ASSERT_EQ(out[i].f[6], expected.pdf);
  }
}

TEST(GpuLights, NoLightNoSample) {
  FlatScene scene;
  const ItemOut light = run_items(probe(), "light", scene, points_around({0, 0, 0}, 1, 1, 23))[0];
  EXPECT_EQ(light.f[6], 0);
  scene = scene_with_light(make_shape(KB_SHAPE_SPHERE, identity()));
  scene.shapes[0].emitter = KB_NONE;
  const ItemOut density = run_items(probe(), "density", scene, points_around({0, 0, 3}, 1, 1, 24))[0];
  EXPECT_EQ(density.f[0], 0);
  EXPECT_EQ(density.f[1], 0);  // no environment either
}

}  // namespace
}  // namespace kiloband::test::emitter_test
