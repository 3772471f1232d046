// Transmission through rough boundaries on a device against its definition in double, up to the errors that rounded directions leave.
#include "device_scene.hpp"
#include "tests/unit/src_cpu/evaluate/rough_pairs.hpp"

namespace kiloband::test::rough_transmission_test {
namespace {

RoundOfPaths one_round(std::size_t paths) {
  RoundOfPaths round;
  round.pixels = static_cast<uint32_t>(paths);
  for (uint32_t p = 0; p < round.pixels; ++p) round.path.push_back(p);
  round.mu = {0};
  round.block.assign(paths, 0);
  return round;
}

/// A row of the device holds e - 1 rounded, which is one of the roundings allowed for.
TEST(DeviceRoughTransmission, HoldsTheDigitsThatDirectionsHave) {
  EvaluatorProgram program({});
  for (const float alpha : {1.0f, 0.1f, 0.01f, 1e-3f}) {
    for (const bool ggx : {false, true}) {
      for (const bool inside : {false, true}) {
        const RoughPairs pairs(alpha, ggx, inside);
        const opencl::ChannelTables tables = opencl::make_channel_tables(pairs.scene, {});
        const RoundOfPaths round = one_round(pairs.paths.paths.size());
        DeviceEvaluator device(program, pairs.scene, tables, round.pixels);
        device.load(pairs.paths, round, false);
        device.batch(3, 5);
        const Errors errors = errors_of(pairs, device.means(), pairs.index.size());
        EXPECT_LE(errors.largest, 1) << "alpha " << alpha << " ggx " << ggx << " inside " << inside;
        EXPECT_GT(errors.counted, 1000u);
      }
    }
  }
}

std::vector<float> values_of(const RoughPairs& pairs) {
  EvaluatorProgram program({});
  const opencl::ChannelTables tables = opencl::make_channel_tables(pairs.scene, {});
  const RoundOfPaths round = one_round(pairs.paths.paths.size());
  DeviceEvaluator device(program, pairs.scene, tables, round.pixels);
  device.load(pairs.paths, round, false);
  device.batch(3, 5);
  return device.means();
}

TEST(DeviceRoughTransmission, HorizontalFacetsAreDark) {
  const RoughPairs pairs = horizontal_facet();
  const std::vector<float> values = values_of(pairs);
  for (const std::size_t k : kHorizontal) EXPECT_EQ(values[k], 0) << pairs.index[k];
}

TEST(DeviceRoughTransmission, FacetsSeenEdgeOnStayFinite) {
  for (const float value : values_of(edge_on_facets())) {
    ASSERT_GE(value, 0);
    ASSERT_LT(value, 1e6);
  }
}

}  // namespace
}  // namespace kiloband::test::rough_transmission_test
