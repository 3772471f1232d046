// Paths are the same, bit for bit, whether one lane builds them or a vector of lanes.
#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "src_cpu/path/path_tracer.hpp"
#include "tests/support/scene_zoo.hpp"

namespace kiloband::test {
namespace {

using namespace cpu;

constexpr PixelRect kBlock{0, 0, 32, 32};

struct Traced {
  PathBuffer paths;
  std::vector<uint32_t> invalid;
  uint64_t rays = 0, vertices = 0;
};

Traced trace(const FlatScene& scene, const EmbreeScene& embree, SamplerType sampler,
             const PathKernels& kernels) {
  const TracerScene tracer_scene{&scene, &embree};
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

TEST_P(PathsOfLanes, AreThoseOfOneLane) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(GetParam());
  const EmbreeScene embree(scene, "sse4.2", 1);
  for (const SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
    const Traced one = trace(scene, embree, sampler, one_lane_path_kernels());
    for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
      if (!is_available(isa)) continue;
      SCOPED_TRACE(to_string(isa));
      expect_same_bits(one, trace(scene, embree, sampler, path_kernels(isa)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Zoo, PathsOfLanes, testing::ValuesIn(scene_zoo()),
                         [](const auto& scene) { return scene.param.name; });

}  // namespace
}  // namespace kiloband::test
