// Sizes that `kiloband tune` tries and takes, with clocks that are made up.
#include "src_gpu/tuning/tuner.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kiloband::test::tuner_test {
namespace {

using namespace opencl;

TuningBounds gpu_bounds() {
  return {.method = Method::kDpeptBatch,
          .cpu_device = false,
          .pool_slots = 1u << 20,
          .round_paths = 1u << 22,
          .path_group = 64,
          .evaluation_group = 256,
          .largest_group = 1024,
          .largest_evaluation_group = 1024};
}

std::vector<std::string> names(const std::vector<Ladder>& ladders) {
  std::vector<std::string> all;
  for (const Ladder& ladder : ladders) all.push_back(ladder.name);
  return all;
}

TEST(Tuner, SearchesWhatTheDeviceHas) {
  TuningBounds bounds = gpu_bounds();
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(tuning_ladders(bounds)),
            (Names{"pool_slots", "round_paths", "path_group", "evaluation_group"}));
  bounds.method = Method::kPt;  // has no rounds of saved paths
  EXPECT_EQ(names(tuning_ladders(bounds)), (Names{"pool_slots", "path_group", "evaluation_group"}));
  bounds.cpu_device = true;
  EXPECT_EQ(names(tuning_ladders(bounds)), Names{"pool_slots"});
}

TEST(Tuner, LaddersBeginAtTheUsualSizes) {
  for (const uint64_t usual : {100u, 256u, 1000u, 1u << 13}) {
    TuningBounds bounds = gpu_bounds();
    bounds.pool_slots = bounds.round_paths = usual;
    bounds.evaluation_group = 64;
    const auto ladders = tuning_ladders(bounds);
    EXPECT_EQ(ladders[0].values[ladders[0].start], usual);
    EXPECT_EQ(ladders[1].values[ladders[1].start], usual);
    EXPECT_EQ(ladders[2].values[ladders[2].start], 64u);
    EXPECT_EQ(ladders[3].values[ladders[3].start], 64u);
    for (const Ladder& ladder : ladders) EXPECT_TRUE(std::ranges::is_sorted(ladder.values));
  }
}

/// Sizes that come to the same are no rungs: groups beyond what the channels give work, paths beyond those of the render.
TEST(Tuner, LaddersEndWhereSizesComeToTheSame) {
  DeviceInfo gpu;
  gpu.type = DeviceType::kGpu;
  gpu.max_work_group_size = 1024;
  constexpr uint64_t kBudget = uint64_t{8} << 30;
  const auto last = [&](const TunedRender& render, std::size_t ladder) {
    return tuning_ladders(tuning_bounds(gpu, render, kBudget)).at(ladder).values.back();
  };
  TunedRender render{{Method::kDpeptBatch, true, 100}, uint64_t{1} << 40};
  EXPECT_EQ(tuning_bounds(gpu, render, kBudget).evaluation_group,
            64u);  // two pixels with a vector of four channels each, in groups of 32
  EXPECT_EQ(last(render, 3), 512u);
  render.task.method = Method::kPt;  // a path has a group
  EXPECT_EQ(tuning_bounds(gpu, render, kBudget).evaluation_group, 128u);
  EXPECT_EQ(tuning_ladders(tuning_bounds(gpu, render, kBudget)).at(2).values.back(), 128u);
  render.task.method = Method::kDpeptBatch;
  render.task.channels = 4000;  // vectors of 4
  EXPECT_EQ(tuning_bounds(gpu, render, kBudget).evaluation_group, 256u);
  EXPECT_EQ(last(render, 3), 1024u);
  render.task.channels = 512;  // 32 items of 16 channels share a path where vertices are plain, 128 elsewhere
  EXPECT_EQ(tuning_bounds(gpu, render, kBudget).evaluation_group, 128u);
  EXPECT_EQ(tuning_bounds(gpu, render, kBudget).items_of_path, 128u);
  render.task.vertices = VertexSpectra::kOneReflectance;
  EXPECT_EQ(tuning_bounds(gpu, render, kBudget).evaluation_group, 64u);
  EXPECT_EQ(tuning_bounds(gpu, render, kBudget).items_of_path, 32u);
  EXPECT_EQ(last(render, 3), 512u);
  render.task.method = Method::kDpeptPath;  // an item has a path, whatever the channels are
  render.task.channels = 100;
  EXPECT_EQ(last(render, 3), 1024u);
  const uint64_t usual = usual_jobs(false, kBudget);
  EXPECT_EQ(last(render, 1), usual << 4);
  render.paths = 2 * usual - 5;
  EXPECT_EQ(last(render, 1), 2 * usual);
  render.paths = 1000;  // the usual size stays, as the place where the search begins
  EXPECT_EQ(last(render, 1), usual);
  // Of those below it, only such as not all paths fit: noise would choose among the others.
  TuningBounds bounds = gpu_bounds();
  bounds.pool_slots = bounds.round_paths = 1u << 12;
  const auto rungs = [&](uint64_t paths) {
    bounds.paths = paths;
    return tuning_ladders(bounds)[0].values;
  };
  EXPECT_EQ(rungs(600), (std::vector<uint64_t>{256, 512, 1u << 12}));
  EXPECT_EQ(rungs(1u << 12), (std::vector<uint64_t>{256, 512, 1024, 2048, 1u << 12}));
  EXPECT_EQ(rungs(64), (std::vector<uint64_t>{1u << 12}));
}

/// A clock that has its least time with one size of everything.
std::optional<double> time_around(const Tuning& t) {
  const auto apart = [](double value, double best) { return std::abs(std::log2(value / best)); };
  const double octaves = apart(t.pool_slots.value_or(1u << 20), 1u << 21) +
                         apart(static_cast<double>(t.round_paths.value_or(1u << 22)), 1u << 20) +
                         apart(t.path_group.value_or(64), 128) + apart(t.evaluation_group.value_or(256), 256);
  return 1 + 0.1 * octaves;
}

TEST(Tuner, FindsTheSizesOfTheLeastTime) {
  const TuneOutcome outcome = find_tuning(gpu_bounds(), time_around, {});
  EXPECT_EQ(outcome.tuning.pool_slots, 1u << 21);
  EXPECT_EQ(outcome.tuning.round_paths, 1u << 20);
  EXPECT_EQ(outcome.tuning.path_group, 128u);
  EXPECT_FALSE(outcome.tuning.evaluation_group);  // the usual one
  EXPECT_NEAR(outcome.speed_up, 1.4, 1e-9);
}

TEST(Tuner, KeepsTheUsualSizesWhereOthersGainNothing) {
  const TuneOutcome outcome = find_tuning(gpu_bounds(), [](const Tuning&) { return 1.0; }, {});
  EXPECT_EQ(outcome.tuning, Tuning{});
  EXPECT_EQ(outcome.speed_up, 1);
}

TEST(Tuner, GoesAroundSizesThatTheDeviceRefuses) {
  const auto refusing = [](const Tuning& t) -> std::optional<double> {
    if (t.pool_slots.value_or(1u << 20) > 1u << 20) return std::nullopt;  // no memory for them
    return time_around(t);
  };
  const TuneOutcome outcome = find_tuning(gpu_bounds(), refusing, {});
  EXPECT_FALSE(outcome.tuning.pool_slots);
  EXPECT_EQ(outcome.tuning.round_paths, 1u << 20);
}

/// A machine that slows down for good in the middle of the search fools nobody: comparisons are made in turns.
TEST(Tuner, DriftIsNoGain) {
  double slowness = 10;
  const auto warming_up = [&](const Tuning&) { return slowness = std::max(1.0, slowness * 0.99); };
  EXPECT_EQ(find_tuning(gpu_bounds(), warming_up, {}).tuning, Tuning{});
}

/// What looked faster by an accident is measured again before it is kept.
TEST(Tuner, AnAccidentIsNotKept) {
  int measurements = 0;
  const auto lucky = [&](const Tuning& t) { return ++measurements < 7 && t.pool_slots ? 0.5 : 1.0; };
  EXPECT_EQ(find_tuning(gpu_bounds(), lucky, {}).tuning, Tuning{});
}

TEST(Tuner, TellsEveryComparison) {
  int told = 0, measurements = 0;
  TuneSettings settings;
  settings.told = [&](const Tuning& tried, double speed) {
    ++told;
    EXPECT_NE(tried, Tuning{});
    EXPECT_EQ(speed, 1);
  };
  find_tuning(
      gpu_bounds(),
      [&](const Tuning&) {
        ++measurements;
        return 1.0;
      },
      settings);
  EXPECT_GT(told, 10);
  EXPECT_EQ(measurements, 2 * 3 * told);
}

}  // namespace
}  // namespace kiloband::test::tuner_test
