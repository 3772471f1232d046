// Vertices of gas against the double-precision oracle, on every instruction set.
//
// All terms are positive, so errors are relative to each channel's value. A transmittance exp(-x) has the
// rounding of x times x: up to 30 in a segment, 3e-8 each for kappa, the column and their product, and a path
// here passes 4 segments, of which the thick ones let nothing through: 1e-5, as for other vertices
// (test_oracle.cpp). A plume's Planck ratios add 1e-6.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "random_gas.hpp"
#include "spectral/planck.hpp"
#include "validation/oracle/evaluate_reference.hpp"

namespace kiloband::test::test_gas {
namespace {

constexpr double kTolerance = 1e-5;
constexpr double kFloor = 1e-30;

double largest_error(const FlatScene& scene, const PathBuffer& paths, Isa isa, double mu, bool shared) {
  const Evaluator layout(scene, {}, isa);
  const std::vector<float> sums = evaluate(scene, {}, paths, isa, mu, shared);
  double largest = 0;
  for (std::size_t p = 0; p < paths.paths.size(); ++p) {
    const std::vector<double> expected = evaluate_path_reference(scene, {}, paths, p, mu);
    const float* film = &sums[paths.paths[p].pixel * layout.stride()];
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const double value = film[k] * scene.channel_scale[k];
      const double error = std::abs(value - expected[k]) / (expected[k] + kFloor * scene.channel_scale[k]);
      if (!(error <= largest)) largest = error;
    }
  }
  return largest;
}

class GasOracle : public EachIsa {};
INSTANTIATE_TEST_SUITE_P(, GasOracle, testing::ValuesIn(available_isas()), isa_name);

TEST_P(GasOracle, RandomPathsAgree) {
  std::mt19937 random(21);
  for (const std::size_t count : {1u, 7u, 65u, 300u}) {
    for (const Layout layout : {Layout::kRegular, Layout::kOverlapping, Layout::kNarrow, Layout::kInfrared}) {
      FlatScene scene = make_scene(make_channels(count, layout, random), random);
      add_gas(scene, random);
      const PathBuffer paths = make_gas_paths(scene, 60, random);
      for (const double mu : {0.0, 0.37109375, 0.9375})
        for (const bool shared : {true, false})
          EXPECT_LT(largest_error(scene, paths, GetParam(), mu, shared), kTolerance)
              << count << " channels, layout " << static_cast<int>(layout) << ", mu " << mu << ", shared "
              << shared;
    }
  }
}

/// One homogeneous segment: L = (1 - exp(-x)) B, relative accuracy from x = 1e-8 to 1e4.
TEST_P(GasOracle, OpticalDepthsFromEmptyToBlack) {
  std::mt19937 random(22);
  FlatScene scene = make_scene(make_channels(16, Layout::kInfrared, random), random);
  add_gas(scene, random);
  KbPathVertex v{};
  v.head = KB_KIND_MEDIUM | KB_VERTEX_EMIT | KB_VERTEX_SCATTER;
  v.row_a = static_cast<uint16_t>(scene.spectra.size() - 4);
  v.emit_row = static_cast<uint16_t>(scene.spectra.size() - 1);
  v.emit_weight = 1;
  for (const double depth : {1e-8, 1e-6, 1e-3, 0.3, 0.35, 1.0, 20.0, 1e4, 1e30}) {
    v.scatter0 = static_cast<float>(depth);
    const PathBuffer paths{{v}, {{0, 1, 0}}};
    EXPECT_LT(largest_error(scene, paths, GetParam(), 0.25, true), 5e-7) << depth;
  }
}

/// Planck's law relative to a reference, over exponents hc / (k lambda T) of up to 240: plumes whose
/// single cell is black.
TEST_P(GasOracle, PlanckRatioOverTheFloatRange) {
  std::mt19937 random(23);
  ChannelList channels;
  for (double nm = 300; nm < 20000; nm *= 1.05) channels.push_back({nm, nm * 1.0001, {}});
  double largest = 0;
  for (const double reference : {200.0, 700.0, 6000.0}) {
    FlatScene scene = make_scene(channels, random);
    add_gas(scene, random);
    SpectrumRow& hot = scene.spectra.back();
    hot.temperature_k = reference;
    for (std::size_t k = 0; k < channels.size(); ++k)
      scene.channel_scale[k] = std::exp2(std::floor(
          std::log2(planck_radiance(channels[k].centre_nm(), reference) * channels[k].width_nm())));
    for (const double ratio : {1.0, 0.999, 0.95, 0.8, 0.5, 0.2}) {
      KbPathVertex v{};
      v.head = KB_KIND_MEDIUM | KB_VERTEX_EMIT | 1u << KB_VERTEX_MATERIAL_SHIFT;
      v.row_a = static_cast<uint16_t>(scene.spectra.size() - 4);
      v.emit_row = static_cast<uint16_t>(scene.spectra.size() - 1);
      v.emit_weight = 1;
      v.nee0 = static_cast<float>(ratio * reference);
      v.nee1 = static_cast<float>(reference);
      PathBuffer paths{{v, KbPathVertex{}}, {{0, 2, 0}}};
      const KbPlumeCell cell{1e6f, v.nee0};
      std::memcpy(static_cast<void*>(&paths.entries[1]), &cell, sizeof cell);
      largest = std::max(largest, largest_error(scene, paths, GetParam(), 0.25, true));
    }
  }
  EXPECT_LT(largest, 1e-5);
  EXPECT_GT(largest, 0);
}

/// A plume of three cells up to 3000 K in these channels.
std::vector<float> plume_values(const ChannelList& channels, Isa isa) {
  constexpr float kTop = 3000;
  std::mt19937 random(24);
  FlatScene scene = make_scene(channels, random);
  add_gas(scene, random);
  scene.spectra.back().temperature_k = kTop;
  scene.spectra.push_back(row(table(1000, 30000, {0.5, 2})));
  scene.channel_scale.assign(channels.size(), 1);
  constexpr KbPlumeCell kCells[] = {{0.3f, 2500}, {0.5f, 2000}, {0.2f, 1500}};
  KbPathVertex v{};
  v.head = KB_KIND_MEDIUM | KB_VERTEX_EMIT | 3u << KB_VERTEX_MATERIAL_SHIFT;
  v.row_a = static_cast<uint16_t>(scene.spectra.size() - 1);
  v.emit_row = static_cast<uint16_t>(scene.spectra.size() - 2);
  v.emit_weight = 1;
  v.nee0 = 0.97f * kTop;
  v.nee1 = kTop;
  PathBuffer paths{{v, KbPathVertex{}}, {{0, 2, 0}}};
  std::memcpy(static_cast<void*>(&paths.entries[1]), kCells, sizeof kCells);
  std::vector<float> values = evaluate(scene, {}, paths, isa, 0.25);
  values.resize(channels.size());
  return values;
}

/// hc / (k lambda T) from 0.25 to 5: Planck's ratio is taken in both of its ways, for each channel by itself.
TEST_P(GasOracle, ChannelsDoNotDependOnTheirNeighbours) {
  ChannelList channels;
  for (const double nm : {2000, 4000, 8000, 9000, 10000, 15000, 20000})
    channels.push_back({nm, nm + 100, {}});
  const std::vector<float> together = plume_values(channels, GetParam());
  for (std::size_t k = 0; k < channels.size(); ++k) {
    EXPECT_GT(together[k], 0) << k;
    EXPECT_EQ(plume_values({channels[k]}, GetParam())[0], together[k]) << k;
  }
}

}  // namespace
}  // namespace kiloband::test::test_gas
