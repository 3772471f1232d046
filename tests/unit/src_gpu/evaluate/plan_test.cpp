// Sizes that follow from the device: paths in flight and of a round, work-groups, which evaluation is built.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "src_gpu/evaluate/evaluation.hpp"
#include "src_gpu/told_samples.hpp"

namespace kiloband::test {
namespace {

using namespace opencl;

constexpr uint64_t kGiB = uint64_t{1} << 30;

TEST(GpuPlan, SlotsAndJobsByMemory) {
  EXPECT_EQ(gpu_slots(0), 1u << 16);
  EXPECT_EQ(gpu_slots(2 * kGiB), 1u << 19);
  EXPECT_EQ(gpu_slots(4 * kGiB), 1u << 20);
  EXPECT_EQ(gpu_slots(8 * kGiB), 1u << 21);
  EXPECT_EQ(gpu_slots(80 * kGiB), 1u << 21);
  EXPECT_EQ(gpu_jobs(0), 1u << 16);
  EXPECT_EQ(gpu_jobs(4 * kGiB), 1u << 21);
  EXPECT_EQ(gpu_jobs(8 * kGiB), 1u << 22);
  EXPECT_EQ(gpu_jobs(80 * kGiB), 1u << 24);
}

/// What pt keeps of every channel for the paths in flight stays within 4 MiB where launches are long enough with that.
TEST(GpuPlan, SlotsOfCpusByTheStateOfTheirPaths) {
  const auto slots = [](uint64_t channels) { return usual_slots(true, kGiB, 2 * sizeof(float) * channels); };
  EXPECT_EQ(slots(0), 1u << 15);  // dpept
  EXPECT_EQ(slots(16), 1u << 15);
  EXPECT_EQ(slots(17), 1u << 14);
  EXPECT_EQ(slots(100), 1u << 12);
  EXPECT_EQ(slots(256), 1u << 11);
  EXPECT_EQ(slots(4096), 1u << 11);
  EXPECT_EQ(usual_slots(false, kGiB, 0), gpu_slots(kGiB));
}

/// A sensor of 8 x 8 pixels: 16 rounds of 64 samples are one; many pixels, large tables and what would sum otherwise have rounds as before.
TEST(GpuPlan, RoundsOfFewPixelsAreOne) {
  const SumRule gpu = sum_rule_of(Method::kDpeptBatch, 64, false);
  EXPECT_EQ(rounds_as_one({gpu, 32, 0, 1u << 21, 64, 1024}), 16u);
  EXPECT_EQ(rounds_as_one({gpu, 32, 0, 1u << 21, 64, 1025}), 32u);
  EXPECT_EQ(rounds_as_one({gpu, 32, 0, 1u << 21, 64, 1u << 30}), 512u);
  EXPECT_EQ(rounds_as_one({gpu, 32, 0, 1u << 21, 1, 1u << 30}), 1u << 15);
  EXPECT_EQ(rounds_as_one({gpu, 32, 0, 1u << 21, 1u << 15, 1u << 30}), 1u);
  EXPECT_EQ(rounds_as_one({gpu, 32, 0, 1u << 21, 1u << 20, 1u << 30}), 1u);
  EXPECT_EQ(rounds_as_one({gpu, 32, 1u << 10, 1u << 21, 1, 1u << 30}), 64u) << "4 MiB of tables";
  EXPECT_EQ(rounds_as_one({gpu, 32, 1u << 16, 1u << 21, 1, 1u << 30}), 1u);
  EXPECT_EQ(rounds_as_one({sum_rule_of(Method::kDpeptBatch, 50, false), 32, 0, 1u << 21, 1, 1000}), 1u);
  EXPECT_EQ(rounds_as_one({sum_rule_of(Method::kDpeptBatch, 20, false), 32, 0, 1u << 21, 1, 1000}), 1u);
  EXPECT_EQ(rounds_as_one({sum_rule_of(Method::kDpeptBatch, 64, true), 32, 0, 1u << 21, 1, 1000}), 1u)
      << "derived channels";
  EXPECT_EQ(rounds_as_one({sum_rule_of(Method::kPt, 64, false), 32, 0, 1u << 21, 1, 1000}), 1u);
  const SumRule cpu = sum_rule_of(Method::kDpeptPath, samples_of_round(true, 0), false);
  EXPECT_EQ(rounds_as_one({cpu, samples_in_registers(true), 0, 1u << 15, 64, 1u << 20}), 32u);
}

/// Two pixels, rounds of 64 samples: the pool has room for as many as are one.
TEST(GpuPlan, PoolsHaveRoomForRoundsThatAreOne) {
  PlanRequest request;
  request.budget = request.largest = kGiB;
  request.pixels = 2, request.samples = 64, request.film_bytes = 100, request.table_bytes = 100;
  request.most_slots = 1u << 15, request.most_jobs = 1u << 17;
  const RoundPlan alone = plan_rounds(request);
  EXPECT_EQ(alone.round_jobs, 128u);
  EXPECT_EQ(alone.pool.tables, 128u);
  request.rounds = 10;
  const RoundPlan as_one = plan_rounds(request);
  EXPECT_EQ(as_one.round_jobs, 1280u);
  EXPECT_EQ(as_one.pool.jobs, 1280u);
  EXPECT_EQ(as_one.pool.slots, 640u);
  EXPECT_EQ(as_one.pool.tables, 1280u);
  request.table_bytes = 1u << 20;  // a fifth of the budget: 204 tables
  EXPECT_EQ(plan_rounds(request).pool.tables, 204u);
}

/// Samples [first, first + samples) in parts of no more than `fitting`, as a renderer takes them.
void take_apart(uint32_t first, uint32_t samples, uint32_t fitting, uint32_t round,
                std::vector<uint32_t>& begins) {
  if (samples <= fitting) return begins.push_back(first);
  const uint32_t half = first_part(samples, round);
  take_apart(first, half, fitting, round, begins);
  take_apart(first + half, samples - half, fitting, round, begins);
}

/// Whatever fits, as long as a round does: parts begin with rounds.
TEST(GpuPlan, RoundsThatWereOnePartBetweenRounds) {
  for (const uint32_t round : {16u, 64u}) {
    for (uint32_t samples = 2; samples <= 20 * round; ++samples) {
      for (uint32_t fitting = round; fitting < 3 * round; fitting += 5) {
        std::vector<uint32_t> begins;
        take_apart(0, samples, fitting, round, begins);
        for (const uint32_t begin : begins) ASSERT_EQ(begin % round, 0u) << samples << ", " << fitting;
      }
    }
  }
  EXPECT_EQ(first_part(16, 16), 8u);
  EXPECT_EQ(first_part(17, 16), 16u);
  EXPECT_EQ(first_part(100, 16), 48u);
}

TEST(GpuPlan, WorkGroupsFitTheKernel) {
  const auto fitting = [](uint32_t items, uint32_t pixels, uint64_t limit) {
    EvaluationShape shape;
    shape.local_size = items;
    shape.units_per_group = pixels;
    shape.staged = pixels > 1;
    return fitting_local_size(shape, limit);
  };
  EXPECT_EQ(fitting(128, 1, 256), 128u);
  EXPECT_EQ(fitting(256, 1, 256), 256u);
  EXPECT_EQ(fitting(256, 1, 255), 224u);
  EXPECT_EQ(fitting(64, 1, 40), 32u);
  EXPECT_EQ(fitting(64, 1, 20), 20u);
  EXPECT_EQ(fitting(128, 2, 256), 128u);
  EXPECT_EQ(fitting(128, 2, 255), 96u);
  EXPECT_EQ(fitting(8, 16, 100), 6u);
  EXPECT_EQ(fitting(8, 16, 16), 1u);
  EXPECT_THROW(fitting(8, 16, 15), DeviceError);
}

/// A lost attempt, and one that is repeated in smaller parts: nothing is told twice, and all is told.
TEST(ToldSamples, AreToldOnce) {
  std::vector<uint64_t> told;
  opencl::ToldSamples samples([&](uint64_t some) { told.push_back(some); });
  samples.begin_attempt();
  samples.add(5);
  samples.deliver();
  samples.begin_attempt();  // lost after 7 of 12
  samples.add(4), samples.add(3);
  for (int part = 0; part < 3; ++part) {
    samples.begin_attempt();
    samples.add(4);
    samples.deliver();
  }
  EXPECT_EQ(told, (std::vector<uint64_t>{5, 4, 3, 1, 4}));
  opencl::ToldSamples nobody({});
  nobody.begin_attempt();
  nobody.add(1);
}

/// Vertices are staged by work-groups of GPUs that evaluate a path together, and by nothing else.
TEST(GpuPlan, WhoStagesVertices) {
  DeviceInfo device;
  device.max_work_group_size = 1024;
  for (const DeviceType type : {DeviceType::kGpu, DeviceType::kAccelerator, DeviceType::kCpu}) {
    device.type = type;
    for (const Method method : {Method::kDpeptBatch, Method::kDpeptPath, Method::kPt}) {
      const EvaluationShape shape = evaluation_shape(device, {method, true, 512});
      const bool staged = type != DeviceType::kCpu && method == Method::kDpeptBatch;
      EXPECT_EQ(shape.staged, staged);
      const std::vector<std::string> defines = shape.defines(0);
      EXPECT_EQ(std::ranges::count(defines, staged ? "KB_STAGED=1" : "KB_STAGED=0"), 1);
    }
  }
}

/// Pixels side by side fill a group that channels alone do not fill; groups are no larger than is asked for.
TEST(GpuPlan, PixelsSideBySide) {
  DeviceInfo device;
  device.type = DeviceType::kGpu;
  device.max_work_group_size = 1024;
  for (const VertexSpectra vertices : {VertexSpectra::kAny, VertexSpectra::kOneReflectance}) {
    const auto shape = [&](uint32_t channels, std::optional<uint32_t> largest = {}) {
      return evaluation_shape(device, {Method::kDpeptBatch, true, channels, vertices}, largest);
    };
    for (uint32_t channels = 1; channels < 3000; channels += 7) {
      for (const uint32_t largest : {32u, 64u, 256u, 1024u}) {
        const EvaluationShape s = shape(channels, largest);
        const uint32_t of_item = s.width * s.vectors;
        EXPECT_LE(s.group_size(), largest);
        EXPECT_GE(s.local_size * of_item, std::min(channels, largest * of_item));
        EXPECT_TRUE(s.units_per_group == 16 || 2 * s.group_size() > largest) << channels << " " << largest;
      }
    }
    EXPECT_EQ(shape(512, 128).group_size(), 128u);
    EXPECT_EQ(shape(512, 512).group_size(), 512u);
  }
}

/// Several vectors for a work-item: where vertices have one reflectance each and all paths the same wavelengths, and as many as leave a warp full.
TEST(GpuPlan, VectorsOfAWorkItem) {
  DeviceInfo device;
  device.type = DeviceType::kGpu;
  device.max_work_group_size = 1024;
  SceneFeatures features;
  features.diffuse = features.dielectric = features.checkerboard = features.area_light = true;
  const auto shape = [&](uint32_t channels, bool shared = true, bool specialised = true) {
    return evaluation_shape(device,
                            {Method::kDpeptBatch, shared, channels, vertex_spectra(features, specialised)});
  };
  const std::vector<std::pair<uint32_t, uint32_t>> expected{
      {1, 1}, {64, 1}, {128, 1}, {160, 2}, {256, 2}, {300, 3}, {384, 3}, {512, 4}, {800, 4}, {4096, 4}};
  for (const auto& [channels, vectors] : expected) EXPECT_EQ(shape(channels).vectors, vectors) << channels;
  EXPECT_EQ(shape(512).local_size, 32u);
  EXPECT_EQ(shape(512).units_per_group, 2u);
  EXPECT_EQ(shape(512).most_registers, 120u);
  EXPECT_EQ(shape(512, false).vectors, 1u);
  EXPECT_EQ(shape(512, true, false).vectors, 1u);
  EXPECT_EQ(shape(512, true, false).most_registers, 96u);
  features.plastic = true;
  EXPECT_EQ(shape(512).vectors, 1u);
  EXPECT_EQ(shape(512).most_registers, 56u);
  features.bitmap = true;
  EXPECT_EQ(shape(512).most_registers, 96u);
}

/// Each feature alone, beside diffuse surfaces under a lamp.
TEST(GpuPlan, FeaturesAndTheirSpectra) {
  const std::set<std::string> any{"conductor",       "roughconductor",    "dispersion", "bitmap",
                                  "environment map", "temperature field", "gas"},
      rows{"roughdielectric", "plastic", "roughplastic", "principled"};
  const auto check = [&](const SceneFeatures& features, const std::string& name) {
    const VertexSpectra expected = any.contains(name)    ? VertexSpectra::kAny
                                   : rows.contains(name) ? VertexSpectra::kRows
                                                         : VertexSpectra::kOneReflectance;
    EXPECT_EQ(vertex_spectra(features, true), expected) << name;
    EXPECT_EQ(vertex_spectra(features, false), VertexSpectra::kAny) << name;
  };
#define KB_CHECK_SPECTRA(macro, member, name) \
  {                                           \
    SceneFeatures features;                   \
    features.member = true;                   \
    check(features, name);                    \
  }
  KB_SCENE_FEATURES(KB_CHECK_SPECTRA)
#undef KB_CHECK_SPECTRA
}

}  // namespace
}  // namespace kiloband::test
