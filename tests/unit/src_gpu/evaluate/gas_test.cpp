// Vertices of gas on an OpenCL device against the oracle, in all three methods; rows of lines;
// builds without gas.
//
// Tolerance as in device_evaluator_test.cpp. A line's flank of a hundredth of a channel turns the rounding of
// mu, 3e-8, into 3e-6 of kappa.
#include <cmath>
#include <cstring>

#include "device_scene.hpp"
#include "spectral/planck.hpp"
#include "tests/support/effort.hpp"
#include "tests/unit/src_cpu/evaluate/random_gas.hpp"

namespace kiloband::test::gas_test {

using namespace cpu;
namespace {

constexpr double kTolerance = 1e-5, kRounding = 2e-6;

struct GasWorkload {
  GasWorkload(std::size_t channels, Layout layout, bool per_path, std::mt19937& random)
      : scene(make_device_scene(channels, layout, random)) {
    add_gas(scene, random);
    tables = opencl::make_channel_tables(scene, {});
    paths = make_gas_paths(scene, 60, random);
    round = make_round(paths, 12, 5, random);
    expected = reference(scene, {}, tables, paths, round, per_path);
  }

  FlatScene scene;
  opencl::ChannelTables tables;
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

std::vector<EvaluatorBuild> builds() {
  return with_others_if_thorough<EvaluatorBuild>({{16, 4, false, 0}, {4, 1, true, 0}, {1, 1, false, 0}},
                                                 {{16, 2, true, 0}, {1, 2, true, 0}});
}

INSTANTIATE_TEST_SUITE_P(, DeviceGas, testing::ValuesIn(builds()), build_name);

/// Planck's law relative to a reference, over exponents hc / (k lambda T) of up to 240: plumes
/// of one black cell.
TEST(DeviceGasPlanck, RatioOverTheFloatRange) {
  std::mt19937 random(33);
  EvaluatorProgram program({16, 1, false, 0});
  ChannelList channels;
  for (double nm = 300; nm < 20000; nm *= 1.05) channels.push_back({nm, nm * 1.0001, {}});
  for (const double reference_k : {200.0, 700.0, 6000.0}) {
    FlatScene scene = make_scene(channels, random);
    add_gas(scene, random);
    scene.spectra.back().temperature_k = reference_k;
    for (std::size_t k = 0; k < channels.size(); ++k)
      scene.channel_scale[k] = std::exp2(std::floor(
          std::log2(planck_radiance(channels[k].centre_nm(), reference_k) * channels[k].width_nm())));
    PathBuffer paths;
    for (const double ratio : {1.0, 0.999, 0.95, 0.8, 0.5, 0.2}) {
      KbPathVertex v{};
      v.head = KB_KIND_MEDIUM | KB_VERTEX_EMIT | 1u << KB_VERTEX_MATERIAL_SHIFT;
      v.row_a = static_cast<uint16_t>(scene.spectra.size() - 4);
      v.emit_row = static_cast<uint16_t>(scene.spectra.size() - 1);
      v.emit_weight = 1;
      v.nee0 = static_cast<float>(ratio * reference_k);
      v.nee1 = static_cast<float>(reference_k);
      const KbPlumeCell cell{1e6f, v.nee0};
      paths.paths.push_back(
          {static_cast<uint32_t>(paths.entries.size()), 2, static_cast<uint32_t>(paths.paths.size())});
      paths.entries.push_back(v);
      paths.entries.push_back({});
      std::memcpy(static_cast<void*>(&paths.entries.back()), &cell, sizeof cell);
    }
    RoundOfPaths round;
    round.pixels = 6;
    round.path = {0, 1, 2, 3, 4, 5};
    round.mu = {0.25f};
    round.block.assign(6, 0);
    const opencl::ChannelTables tables = opencl::make_channel_tables(scene, {});
    DeviceEvaluator device(program, scene, tables, 6);
    device.load(paths, round);
    device.batch(1, 6);
    const Expected expected = reference(scene, {}, tables, paths, round, false);
    EXPECT_LT(largest_error(device.means(), expected), kTolerance) << reference_k;
  }
}

/// A row of lines has the knots of its data, whatever their number; other rows are what they are without gas.
TEST(DeviceGasTables, RowsOfLinesKeepTheirKnots) {
  std::mt19937 random(32);
  FlatScene scene = make_device_scene(7, Layout::kRegular, random);
  const opencl::ChannelTables before = opencl::make_channel_tables(scene, {});
  add_gas(scene, random);
  scene.features.plume = false;
  const opencl::ChannelTables tables = opencl::make_channel_tables(scene, {});
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
}  // namespace kiloband::test::gas_test
