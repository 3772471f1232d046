// Paths are the same, bit for bit, whether one lane builds them or a vector of lanes.
#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "scene/read/reader.hpp"
#include "shared/sobol_table.h"
#include "src_cpu/path/path_tracer.hpp"
#include "tests/support/one_path_lights.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/zoo/scene_zoo.hpp"

namespace kiloband::test::test_lanes {
namespace {

using namespace cpu;
using namespace scene_text;

constexpr PixelRect kBlock{0, 0, 32, 32};

struct Traced {
  PathBuffer paths;
  std::vector<uint32_t> invalid;
  uint64_t rays = 0, vertices = 0;
};

Traced trace(const FlatScene& scene, const EmbreeScene& embree, SamplerType sampler,
             const PathKernels& kernels, std::span<const TriangleRecord> records = {},
             std::span<const LightTriangle> lights = {}, const FewTriangles* few = nullptr) {
  const TracerScene tracer_scene{&scene, &embree, records, lights, few};
  SamplingSettings settings;
  settings.sampler = sampler;
  settings.replicates = 1;
  PathTracer tracer(tracer_scene, settings, kernels);
  Traced all;
  const float mu = 0.25f;
  for (uint32_t sample = 0; sample < 3; ++sample) {
    PathBuffer paths;
    std::vector<uint32_t> invalid;
    tracer.trace(kBlock, {sample, 0, sample}, std::span(&mu, 1), paths, invalid);
    for (SavedPath path : paths.paths) {
      path.first += static_cast<uint32_t>(all.paths.entries.size());
      all.paths.paths.push_back(path);
    }
    all.paths.entries.insert(all.paths.entries.end(), paths.entries.begin(), paths.entries.end());
    all.invalid.insert(all.invalid.end(), invalid.begin(), invalid.end());
  }
  all.rays = tracer.rays();
  all.vertices = tracer.vertices();
  return all;
}

std::array<uint32_t, 8> words_of(const KbPathVertex& vertex) {
  return std::bit_cast<std::array<uint32_t, 8>>(vertex);
}

void expect_same_bits(const Traced& expected, const Traced& traced) {
  EXPECT_EQ(traced.rays, expected.rays);
  EXPECT_EQ(traced.vertices, expected.vertices);
  EXPECT_EQ(traced.invalid, expected.invalid);
  ASSERT_EQ(traced.paths.paths.size(), expected.paths.paths.size());
  ASSERT_EQ(traced.paths.entries.size(), expected.paths.entries.size());
  for (std::size_t i = 0; i < expected.paths.entries.size(); ++i) {
    ASSERT_EQ(words_of(traced.paths.entries[i]), words_of(expected.paths.entries[i]))
        << "entry " << i << " of " << expected.paths.entries.size();
  }
}

class PathsOfLanes : public testing::TestWithParam<ZooScene> {};

/// By Embree's hits, and by those of few triangles where the scene has no more.
TEST_P(PathsOfLanes, AreThoseOfOneLane) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(GetParam());
  const EmbreeScene embree(scene, Isa::kSse4, 1);
  const std::optional<FewTriangles> few = find_few_triangles(scene);
  for (const FewTriangles* list : {static_cast<const FewTriangles*>(nullptr), few ? &*few : nullptr}) {
    for (const SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
      const Traced one = trace(scene, embree, sampler, one_lane_path_kernels(), {}, {}, list);
      for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
        if (!is_available(isa)) continue;
        SCOPED_TRACE(to_string(isa));
        expect_same_bits(one, trace(scene, embree, sampler, path_kernels(isa), {}, {}, list));
      }
    }
    if (!few) break;
  }
}

TEST_P(PathsOfLanes, AreThoseWithRecordsOfTriangles) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(GetParam());
  const std::vector<TriangleRecord> records = make_triangle_records(scene);
  ASSERT_EQ(records.size(), scene.triangles.size() / 3);
  const EmbreeScene embree(scene, Isa::kSse4, 1);
  const PathKernels& kernels = path_kernels(resolve_isa(Isa::kAuto));
  const SamplerType sampler = SamplerType::kIndependent;
  const std::vector<LightTriangle> lights = make_light_triangles(scene);
  ASSERT_EQ(lights.size(), scene.area_cdf.size());
  const Traced without = trace(scene, embree, sampler, kernels);
  expect_same_bits(without, trace(scene, embree, sampler, kernels, records, lights));
  expect_same_bits(without, trace(scene, embree, sampler, one_lane_path_kernels(), records, lights));
}

/// Gases, and things that no gas concerns: in a null boundary, in glass, behind a second boundary; camera outside and in a gas, with and
/// without an atmosphere. Lanes tell it of several rays at a time what one lane tells of each.
TEST(GasOfLanes, PathsAreThoseOfOneLane) {
  const auto gas = [](const std::string& absorption, const std::string& name = "interior") {
    return "<medium name='" + name + "' type='homogeneous'><spectrum name='sigma_t' value='" + absorption +
           "'/><spectrum name='albedo' value='0'/></medium>";
  };
  const auto ball = [](const std::string& centre, double radius, const std::string& inside) {
    return "<shape type='sphere'><point name='center' value='" + centre + "'/><float name='radius' value='" +
           std::to_string(radius) + "'/>" + inside + "</shape>";
  };
  const std::string things =
      "<shape type='rectangle'><transform name='to_world'><scale value='8'/><rotate x='1' angle='-90'/></transform>"
      "<bsdf type='diffuse'><spectrum name='reflectance' value='0.5'/></bsdf></shape>" +
      ball("-2,1,0", 1, "<bsdf type='null'/>" + gas("0.4")) +
      ball("-2,1,0.2", 0.5, "<bsdf type='null'/>" + gas("1.5")) +
      ball("-1.7,1.1,0.2", 0.15, "<bsdf type='diffuse'/>") +
      ball("2,1,0", 1, "<bsdf type='dielectric'/>" + gas("0.7")) +
      ball("0,1,-2", 1, "<bsdf type='dielectric'><string name='int_ior' value='bk7'/></bsdf>") +
      ball("0,1,2", 0.8,
           "<bsdf type='mask'><float name='opacity' value='0.5'/><bsdf type='roughconductor'/></bsdf>") +
      ball("-3,0.5,3", 0.5, "<bsdf type='null'/>") +
      "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate value='0,6,0'/></transform>"
      "<emitter type='area'><spectrum name='radiance' value='5'/></emitter></shape>";
  const std::pair<std::string, std::string> views[] = {
      {"0,2,9", ""}, {"-2.2,1.1,0.2", ""}, {"0,2,9", gas("0.05", "atmosphere")}};
  for (const auto& [camera, atmosphere] : views) {
    SCOPED_TRACE(camera + atmosphere);
    const std::string text =
        scene(12, perspective(lookat(camera, "0,1,0"), 60, film(32)) + things + atmosphere + sky("0.3"));
    const ChannelList channels = parse_channels("400:700:3");
    const auto flat = compile_scene(read_scene_text(text, "gas.xml", ".", {}), {channels, channels, {}});
    ASSERT_EQ(flat->atmosphere == KB_NONE, atmosphere.empty());
    const EmbreeScene embree(*flat, Isa::kSse4, 1);
    const SamplerType sampler = SamplerType::kSobol;
    const Traced one = trace(*flat, embree, sampler, one_lane_path_kernels());
    EXPECT_GT(one.paths.paths.size(), 1000u);
    for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
      if (is_available(isa)) expect_same_bits(one, trace(*flat, embree, sampler, path_kernels(isa)));
  }
}

/// A room in an atmosphere, with a body of absorbing glass: nothing there is passed, so that few triangles are its rays', too.
TEST(GasOfLanes, WithoutBoundariesPathsAreThoseOfOneLane) {
  const std::string text =
      scene(12, perspective(lookat("0,1.5,6", "0,1,0"), 60, film(32)) +
                    shape("rectangle", to_world(scale(5, 5, 1) + turn("x", -90)) + diffuse(0.5)) +
                    shape("cube", to_world(scale(0.6, 0.6, 0.6) + translate(1, 1, 0)) + bsdf("dielectric") +
                                      gas("interior", "0.7")) +
                    shape("cube", to_world(scale(0.6, 0.6, 0.6) + translate(-1, 1, 0)) + diffuse(0.8)) +
                    shape("rectangle", to_world(turn("x", 90) + translate(0, 5, 0)) + lamp(5)) +
                    gas("atmosphere", "0.05") + sky(0.3));
  const ChannelList channels = parse_channels("400:700:3");
  const auto flat = compile_scene(read_scene_text(text, "gas.xml", ".", {}), {channels, channels, {}});
  const EmbreeScene embree(*flat, Isa::kSse4, 1);
  const std::optional<FewTriangles> few = find_few_triangles(*flat);
  ASSERT_TRUE(few);
  const SamplerType sampler = SamplerType::kSobol;
  const Traced of_embree = trace(*flat, embree, sampler, one_lane_path_kernels());
  const Traced one = trace(*flat, embree, sampler, one_lane_path_kernels(), {}, {}, &*few);
  EXPECT_GT(one.paths.paths.size(), 1000u);
  EXPECT_NEAR(static_cast<double>(one.vertices), static_cast<double>(of_embree.vertices),
              1e-3 * static_cast<double>(of_embree.vertices));  // hits differ in last places
  for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!is_available(isa)) continue;
    expect_same_bits(of_embree, trace(*flat, embree, sampler, path_kernels(isa)));
    expect_same_bits(one, trace(*flat, embree, sampler, path_kernels(isa), {}, {}, &*few));
  }
}

/// A floor whose lamp a roof hides half, without gas, with some far off, in an atmosphere and with both: as many rays, and in an atmosphere
/// as many vertices.
TEST(GasOfLanes, HiddenShadowRaysAreCountedOnce) {
  const std::string room =
      "<shape type='rectangle'><transform name='to_world'><scale value='8'/><rotate x='1' angle='-90'/></transform>"
      "<bsdf type='diffuse'/></shape><shape type='disk'><transform name='to_world'><rotate x='1' angle='-90'/>"
      "<translate value='1,2,0'/></transform><bsdf type='diffuse'/></shape>"
      "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate value='0,6,0'/></transform>"
      "<emitter type='area'><spectrum name='radiance' value='5'/></emitter></shape>";
  const std::string far_off =
      "<shape type='sphere'><point name='center' value='0,500,0'/><bsdf type='null'/>"
      "<medium name='interior' type='homogeneous'><spectrum name='sigma_t' value='1'/><spectrum name='albedo' value='0'/>"
      "</medium></shape>";
  const ChannelList channels = parse_channels("400:700:3");
  const std::string atmosphere = gas("atmosphere", "0.01");
  std::vector<uint64_t> rays, vertices;
  for (const std::string& more : {std::string(), far_off, atmosphere, atmosphere + far_off}) {
    const auto flat = compile_scene(
        read_scene_text(scene(3, perspective(lookat("0,9,9", "0,1,0"), 30, film(32)) + room + more),
                        "roof.xml", ".", {}),
        {channels, channels, {}});
    ASSERT_EQ(flat->features.gas, !more.empty());
    const EmbreeScene embree(*flat, Isa::kSse4, 1);
    const Traced traced = trace(*flat, embree, SamplerType::kSobol, path_kernels(resolve_isa(Isa::kAuto)));
    rays.push_back(traced.rays), vertices.push_back(traced.vertices);
  }
  EXPECT_EQ(rays, std::vector<uint64_t>(4, rays[0]));
  EXPECT_EQ(vertices[1], vertices[0]);
  EXPECT_GT(vertices[2], 2 * vertices[0]);
  EXPECT_EQ(vertices[3], vertices[2]);
}

TEST(TriangleRecords, AreLeftOutOfScenesWithTooMany) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(zoo_scene("diffuse_room"));
  const std::size_t count = scene.triangles.size() / 3;
  ASSERT_GT(count, 1u);
  EXPECT_EQ(make_triangle_records(scene, count).size(), count);
  EXPECT_TRUE(make_triangle_records(scene, count - 1).empty());
  const std::size_t lights = scene.area_cdf.size();
  ASSERT_GT(lights, 1u);
  EXPECT_EQ(make_light_triangles(scene, lights).size(), lights);
  EXPECT_TRUE(make_light_triangles(scene, lights - 1).empty());
}

/// Camera rays of blocks at the edges of a film, and of parts of blocks.
TEST(StartOfLanes, CameraRaysAreThoseOfTheirPixels) {
  FlatScene scene = ZooFolder().flatten(zoo_scene("constant_sky"));
  scene.camera.film_width = 45, scene.camera.film_height = 39;
  const EmbreeScene embree(scene, Isa::kSse4, 1);
  const TracerScene tracer_scene{&scene, &embree};
  SamplingSettings settings;
  settings.sampler = SamplerType::kSobol;
  for (const PixelRect& block :
       {PixelRect{0, 0, 32, 32}, PixelRect{32, 0, 13, 32}, PixelRect{0, 32, 32, 7}, PixelRect{32, 32, 13, 7},
        PixelRect{35, 3, 9, 20}, PixelRect{1, 30, 31, 2}}) {
    std::vector<const PathKernels*> kernels{&one_lane_path_kernels()};
    for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
      if (is_available(isa)) kernels.push_back(&path_kernels(isa));
    for (const PathKernels* kernel : kernels) {
      PathTracer tracer(tracer_scene, settings, *kernel);
      Recording recording;
      tracer.record_into(&recording);
      PathBuffer paths;
      std::vector<uint32_t> invalid;
      tracer.trace(block, {7, 1, 3}, {}, paths, invalid);
      ASSERT_GE(recording.closest.size(), block.pixels());
      for (uint32_t i = 0; i < block.pixels(); ++i) {
        ASSERT_EQ(recording.closest_path[i], i);
        const uint32_t x = block.x0 + i % block.width, y = block.y0 + i / block.width;
        const KbSamplerKey key =
            kb_sampler_key(KB_SAMPLER_SOBOL, settings.seed, kb_sampler_root(settings.seed), y * 45 + x, 7, 1,
                           3, kb_sobol_table);
        const CameraRay ray = sample_camera_ray(scene.camera, x, y, kb_sampler_block(&key, KB_BLOCK_CAMERA));
        const TraceRay& traced = recording.closest[i];
        ASSERT_EQ(traced.origin(), ray.origin) << x << " " << y;
        ASSERT_EQ(traced.direction(), ray.direction) << x << " " << y;
        ASSERT_EQ(traced.t_min, ray.t_min);
        ASSERT_EQ(traced.t_max, ray.t_max);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Zoo, PathsOfLanes, testing::ValuesIn(scene_zoo()),
                         [](const auto& scene) { return scene.param.name; });

}  // namespace
}  // namespace kiloband::test::test_lanes
