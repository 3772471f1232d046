// Vertices of gas on an OpenCL device against the oracle, in all three methods; rows of lines; builds without
// gas.
//
// Tolerance as in device_evaluator_test.cpp. A line's flank of a hundredth of a channel turns the rounding of
// mu, 3e-8, into 3e-6 of kappa.
#include "../cpu_evaluator/random_gas.hpp"
#include "device_scene.hpp"

namespace kiloband::test {
namespace {

constexpr double kTolerance = 1e-5, kRounding = 2e-6;

struct GasWorkload {
  GasWorkload(std::size_t channels, Layout layout, bool per_path, std::mt19937& random)
      : scene(make_device_scene(channels, layout, random)) {
    add_gas(scene, random);
    tables = gpu::make_channel_tables(scene, {});
    paths = make_gas_paths(scene, 60, random);
    round = make_round(paths, 12, 5, random);
    expected = reference(scene, {}, tables, paths, round, per_path);
  }

  FlatScene scene;
  gpu::ChannelTables tables;
  PathBuffer paths;
  RoundOfPaths round;
  Expected expected;
};

class DeviceGas : public testing::TestWithParam<EvaluatorBuild> {};

TEST_P(DeviceGas, RandomPathsAgreeWithTheOracle) {
  EvaluatorProgram program(GetParam());
  std::mt19937 random(31);
  for (const auto& [channels, layout] : {std::pair{1u, Layout::kRegular},
                                         {7u, Layout::kNarrow},
                                         {100u, Layout::kRegular},
                                         {100u, Layout::kOverlapping},
                                         {100u, Layout::kInfrared}}) {
    SCOPED_TRACE(std::to_string(channels) + " channels, layout " + std::to_string(static_cast<int>(layout)));
    const GasWorkload w(channels, layout, GetParam().per_path, random);
    DeviceEvaluator device(program, w.scene, w.tables, w.round.pixels);
    device.load(w.paths, w.round);
    device.batch(3, 5);
    const std::vector<float> batch = device.means();
    EXPECT_LT(largest_error(batch, w.expected), kTolerance);
    device.clear();
    device.path(4);
    EXPECT_LT(largest_difference(device.means(), batch, w.expected), kRounding) << "path";
    device.clear();
    device.pt(w.paths, w.round.pixels / 2, 2);
    EXPECT_LT(largest_difference(device.means(), batch, w.expected), kRounding) << "pt";
  }
}

INSTANTIATE_TEST_SUITE_P(, DeviceGas,
                         testing::Values(EvaluatorBuild{16, 4, false, 0}, EvaluatorBuild{16, 2, true, 0},
                                         EvaluatorBuild{4, 1, true, 0}, EvaluatorBuild{1, 1, false, 0},
                                         EvaluatorBuild{1, 2, true, 0}),
                         [](const auto& p) {
                           return "width" + std::to_string(p.param.width) + "x" +
                                  std::to_string(p.param.vectors) +
                                  (p.param.per_path ? "_per_path" : "_shared");
                         });

/// A row of lines has the knots of its data, whatever their number; other rows are what they are without gas.
TEST(DeviceGasTables, RowsOfLinesKeepTheirKnots) {
  std::mt19937 random(32);
  FlatScene scene = make_device_scene(7, Layout::kRegular, random);
  const gpu::ChannelTables before = gpu::make_channel_tables(scene, {});
  add_gas(scene, random);
  scene.features.plume = false;
  const gpu::ChannelTables tables = gpu::make_channel_tables(scene, {});
  EXPECT_EQ(before.layout.lambda_row, KB_NONE);
  EXPECT_EQ(tables.layout.lambda_row, KB_NONE);
  const std::size_t row = scene.spectra.size() - 4;
  const ChannelKnots& knots = *scene.spectra[row].absorption;
  ASSERT_EQ(tables.tables[row].cells, 0u);
  const float* nodes = &tables.nodes[tables.tables[row].first];
  for (std::size_t k = 0; k < 7; ++k) {
    const uint32_t first = kb_as_u32(nodes[k]), end = kb_as_u32(nodes[k + 1]);
    ASSERT_EQ((end - first) / 2, knots.first[k + 1] - knots.first[k]);
    for (uint32_t i = 0; i < (end - first) / 2; ++i) {
      EXPECT_EQ(nodes[first + 2 * i], static_cast<float>(knots.mu[knots.first[k] + i]));
      EXPECT_EQ(nodes[first + 2 * i + 1], static_cast<float>(knots.value[knots.first[k] + i]));
    }
  }
  for (std::size_t s = 0; s < row; ++s) EXPECT_EQ(tables.tables[s].cells, before.tables[s].cells) << s;
}

}  // namespace
}  // namespace kiloband::test
