// dpept_batch with the stage (kernels/evaluate/stage.clh), as GPUs run it, pixels side by side too, against dpept_batch without, as CPU
// devices run it: the same bits. Derived channels too: a work-item adds its channels in the same order.
#include <algorithm>
#include <array>

#include "device_scene.hpp"
#include "shared/plume.h"
#include "tests/support/effort.hpp"
#include "tests/unit/src_cpu/evaluate/random_gas.hpp"

namespace kiloband::test::staged_test {

using namespace cpu;
namespace {

constexpr uint32_t kFewestEntries = 1 + (KB_PLUME_CELLS + 3) / 4;  // a plume's vertex

struct Result {
  std::vector<float> means;
  std::vector<uint32_t> counts;
  bool operator==(const Result&) const = default;
};

Result evaluated(EvaluatorProgram& program, const FlatScene& scene, const opencl::ChannelTables& tables,
                 const PathBuffer& paths, const RoundOfPaths& round, uint32_t items) {
  DeviceEvaluator device(program, scene, tables, round.pixels);
  device.load(paths, round);
  device.batch(items, program.build.tile > 1 ? 1 : 5);  // groups have more than one turn
  return {device.means(), device.counts()};
}

/// pixels: side by side in a work-group
EvaluatorBuild with_stage(EvaluatorBuild build, std::optional<uint32_t> entries, uint32_t pixels = 1) {
  build.staged = true;
  build.stage_entries = entries;
  build.tile = pixels;
  return build;
}

class StagedEvaluation : public testing::TestWithParam<EvaluatorBuild> {};

/// Work-items of a group: PoCL compiles kernels once for each, which is what takes time here. One for each build; with
/// KILOBAND_THOROUGH set, all.
std::vector<uint32_t> local_sizes(const EvaluatorBuild& build) {
  if (thorough()) return {1, 3, 32};
  return {
      std::array{1u, 3u, 32u}[(build.vectors + (build.per_path ? 1 : 0) + (build.width == 1 ? 2 : 0)) % 3]};
}

/// Textures, temperatures, dispersion; groups with fewer work-items than paths, and with items that have no channels.
TEST_P(StagedEvaluation, SameBitsAsWithout) {
  EvaluatorProgram without(GetParam()), staged(with_stage(GetParam(), {})),
      side_by_side(with_stage(GetParam(), kFewestEntries, 4));
  std::mt19937 random(41);
  for (const std::size_t channels : {1u, 7u, 100u, 300u}) {
    FlatScene scene = make_device_scene(channels, Layout::kRegular, random);
    scene.features.temperature_field = true;
    const opencl::ChannelTables tables = opencl::make_channel_tables(scene, make_responses());
    const PathBuffer paths = make_paths(scene, 40, random);
    const RoundOfPaths round =
        make_round(paths, 6, 70, random);  // more samples than registers take at a time
    for (const uint32_t local_size : local_sizes(GetParam())) {
      const Result expected = evaluated(without, scene, tables, paths, round, local_size);
      EXPECT_GT(*std::ranges::max_element(expected.means), 0);
      EXPECT_EQ(evaluated(staged, scene, tables, paths, round, local_size), expected)
          << channels << " channels, " << local_size << " items";
      EXPECT_EQ(evaluated(side_by_side, scene, tables, paths, round, local_size), expected)
          << channels << " channels, " << local_size << " items of a pixel";
    }
  }
}

/// Paths of hundreds of vertices on a stage of 48 entries: they come in parts, and begin where others have ended. With
/// KILOBAND_THOROUGH in every build, else in the widest, which GPUs get.
TEST_P(StagedEvaluation, PathsLongerThanTheStage) {
  if (!thorough() && GetParam().vectors < 4) GTEST_SKIP() << "with KILOBAND_THOROUGH";
  EvaluatorProgram without(GetParam()), staged(with_stage(GetParam(), kFewestEntries)),
      side_by_side(with_stage(GetParam(), kFewestEntries, 3));
  std::mt19937 random(42);
  const FlatScene scene = make_device_scene(100, Layout::kRegular, random);
  const opencl::ChannelTables tables = opencl::make_channel_tables(scene, make_responses());
  PathBuffer paths = make_paths(scene, 40, random);
  const PathBuffer parts = paths;
  for (std::size_t p = 0; p < paths.paths.size();
       p += 3) {  // every third path is all paths one behind the other
    paths.paths[p].first = static_cast<uint32_t>(paths.entries.size());
    paths.entries.insert(paths.entries.end(), parts.entries.begin(), parts.entries.end());
    paths.paths[p].count = static_cast<uint32_t>(parts.entries.size());
  }
  ASSERT_GT(parts.entries.size(), 4 * kFewestEntries);
  const RoundOfPaths round = make_round(paths, 6, 9, random);
  const Result expected = evaluated(without, scene, tables, paths, round, 3);
  EXPECT_EQ(evaluated(staged, scene, tables, paths, round, 3), expected);
  EXPECT_EQ(evaluated(side_by_side, scene, tables, paths, round, 3), expected);
}

/// Cells of plumes are on the stage, too.
TEST_P(StagedEvaluation, Gas) {
  EvaluatorProgram without(GetParam()), staged(with_stage(GetParam(), kFewestEntries)),
      side_by_side(with_stage(GetParam(), {}, 16));
  std::mt19937 random(43);
  for (const std::size_t channels : {7u, 100u}) {
    FlatScene scene = make_device_scene(channels, Layout::kRegular, random);
    add_gas(scene, random);
    const opencl::ChannelTables tables = opencl::make_channel_tables(scene, make_responses());
    const PathBuffer paths = make_gas_paths(scene, 60, random);
    const RoundOfPaths round = make_round(paths, 18, 25, random);
    const Result expected = evaluated(without, scene, tables, paths, round, 3);
    EXPECT_GT(*std::ranges::max_element(expected.means), 0);
    EXPECT_EQ(evaluated(staged, scene, tables, paths, round, 3), expected) << channels << " channels";
    EXPECT_EQ(evaluated(side_by_side, scene, tables, paths, round, 3), expected) << channels << " channels";
  }
}

/// The widest, the narrowest, and wavelengths of each path.
std::vector<EvaluatorBuild> builds() {
  return with_others_if_thorough<EvaluatorBuild>({{4, 1, true, 4}, {4, 4, false, 4}, {1, 1, false, 4}},
                                                 {{4, 1, false, 4}, {4, 2, false, 4}, {4, 3, false, 4}});
}

INSTANTIATE_TEST_SUITE_P(, StagedEvaluation, testing::ValuesIn(builds()), build_name);

}  // namespace
}  // namespace kiloband::test::staged_test
