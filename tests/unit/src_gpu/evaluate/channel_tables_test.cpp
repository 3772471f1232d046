// Channel tables: node values, the error that they state, jumps, and how overlapping channels share a wavelength.
#include <cmath>

#include "base/error.hpp"
#include "device_scene.hpp"
#include "shared/lang.h"
#include "spectral/planck.hpp"
#include "src_gpu/scene/channel_cover.hpp"
#include "src_gpu/scene/channel_row.hpp"

namespace kiloband::test::channel_tables_test {
namespace {

/// A row that keeps its knots, as kernels/evaluate/spectral_row.clh reads it.
double on_knots(const opencl::ChannelTables& t, uint32_t row, std::size_t k, double mu) {
  const float* heads = &t.nodes[t.tables[row].first];
  const auto begin = [&](std::size_t channel) { return kb_as_u32(heads[channel]); };
  const float* knot = heads + begin(k);
  while (knot + 2 < heads + begin(k + 1) - 2 && knot[2] <= mu) knot += 2;
  return knot[2] > knot[0] ? knot[1] + (mu - knot[0]) / (knot[2] - knot[0]) * (knot[3] - knot[1]) : knot[3];
}

double interpolated(const opencl::ChannelTables& t, uint32_t row, std::size_t k, double mu) {
  const KbChannelTable table = t.tables[row];
  if (table.cells == 0) return on_knots(t, row, k, mu);
  const double position = mu * table.cells;
  const auto cell = std::min<uint32_t>(static_cast<uint32_t>(position), table.cells - 1);
  const float* node = &t.nodes[table.first + std::size_t{cell} * t.layout.stride + k];
  return node[0] + (position - cell) * (static_cast<double>(node[t.layout.stride]) - node[0]);
}

/// Largest error of a row over random mu, relative to its largest value in the channel.
/// float rounding included.
double observed_error(const FlatScene& scene, const opencl::ChannelTables& t, uint32_t s,
                      std::mt19937& random) {
  double worst = 0;
  for (std::size_t k = 0; k < scene.channels.size(); ++k) {
    const Channel& c = scene.channels[k];
    double largest = 0, error = 0;
    for (int i = 0; i < 300; ++i) {
      const double mu = std::uniform_real_distribution<double>(0, 1)(random);
      const double exact = scene.spectra[s].table((1 - mu) * c.min_nm + mu * c.max_nm);
      const double unit = scene.spectra[s].is_emission ? c.width_nm() / scene.channel_scale[k] : 1;
      largest = std::max(largest, std::abs(exact * unit));
      error = std::max(error, std::abs(exact * unit - interpolated(t, s, k, mu)));
    }
    if (largest > 0) worst = std::max(worst, error / largest);
  }
  return worst;
}

TEST(ChannelTables, AreExactWhereNodesMeetKinks) {
  std::mt19937 random(1);
  const FlatScene scene = make_device_scene(40, Layout::kRegular, random);
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {});
  EXPECT_EQ(t.layout.stride, 48u);
  for (uint32_t s = 0; s < scene.spectra.size(); ++s) {
    EXPECT_LE(t.error[s], 1e-6) << s;
    EXPECT_EQ(t.tables[s].first % 16, 0u);
    if (scene.spectra[s].is_planck || t.has_jump[s]) continue;
    EXPECT_LE(t.tables[s].cells, 20u) << s;
    EXPECT_LT(observed_error(scene, t, s, random), 3e-7) << s;
  }
}

TEST(ChannelTables, StateTheirErrorWhereKinksAreAnywhere) {
  std::mt19937 random(2);
  const FlatScene scene = make_scene(make_channels(30, Layout::kOverlapping, random), random);
  opencl::ChannelTableOptions options;
  options.max_cells = 64;
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {}, options);
  int stated = 0;
  for (uint32_t s = 0; s < scene.spectra.size(); ++s) {
    EXPECT_LE(t.tables[s].cells, 64u);
    if (scene.spectra[s].is_planck || t.has_jump[s]) continue;
    // A random sample of a channel may miss its largest value by a little. Knots are at wavelengths in float.
    const double rounding = t.tables[s].cells == 0 ? 1e-6 : 3e-7;
    EXPECT_LE(observed_error(scene, t, s, random), 1.05 * t.error[s] + rounding) << s;
    stated += t.error[s] > 1e-6;
  }
  EXPECT_GT(stated, 0);
}

TEST(ChannelTables, PlanckRowsKeepTheBound) {
  FlatScene scene;
  for (int k = 0; k < 20; ++k) scene.channels.push_back({8000 + 200.0 * k, 8200 + 200.0 * k, {}});
  scene.channel_scale.assign(20, 1.0);
  SpectrumRow thermal;
  thermal.is_planck = thermal.is_emission = true;
  thermal.temperature_k = 300;
  scene.spectra.push_back(thermal);
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {});
  EXPECT_LE(t.error[0], 1e-6);
  EXPECT_LE(t.tables[0].cells, 256u);
}

TEST(ChannelTables, DataThatEndAtAnEdgeDoNotReachAcrossIt) {
  FlatScene scene;
  scene.channels = {{390, 400, {}}, {400, 410, {}}, {410, 420, {}}, {420, 430, {}}};
  scene.channel_scale.assign(4, 1.0);
  scene.spectra.push_back(row(table(400, 10, {0.5, 0.7, 0.9})));
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {});
  EXPECT_FALSE(t.has_jump[0]);
  for (double mu : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(interpolated(t, 0, 0, mu), 0) << mu;
    EXPECT_NEAR(interpolated(t, 0, 1, mu), 0.5 + 0.2 * mu, 1e-7) << mu;
    EXPECT_NEAR(interpolated(t, 0, 2, mu), 0.7 + 0.2 * mu, 1e-7) << mu;
    EXPECT_EQ(interpolated(t, 0, 3, mu), 0) << mu;
  }
}

/// A ramp, as far as it changes the mean by no more than half a cell of 4096 does.
TEST(ChannelTables, AJumpInsideAChannelIsANarrowRampOrAJump) {
  FlatScene scene;
  scene.channels = {{400, 410, {}}};
  scene.channel_scale.assign(1, 1.0);
  scene.spectra.push_back(row(table(400, 4.99, {0.5, 0.5, 0.5})));
  scene.spectra.push_back(row(table(400, 2.5, {0.5, 0.5, 0.5})));
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {});
  EXPECT_TRUE(t.has_jump[0]);
  EXPECT_GE(t.tables[0].cells, 4000u);
  EXPECT_EQ(interpolated(t, 0, 0, 0.9978), 0.5);
  EXPECT_EQ(interpolated(t, 0, 0, 0.9984), 0);
  EXPECT_EQ(t.tables[1].cells, 0u);
  EXPECT_EQ(interpolated(t, 1, 0, 0.499999), 0.5);
  EXPECT_EQ(interpolated(t, 1, 0, 0.500001), 0);
}

/// Mean over a channel of what devices see, by the rule of midpoints.
double device_mean(const opencl::ChannelTables& t, uint32_t row, std::size_t k, double from_mu,
                   double to_mu) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    sum += interpolated(t, row, k, from_mu + (to_mu - from_mu) * (i + 0.5) / kSteps);
  return sum / kSteps * (to_mu - from_mu);
}

/// Lines between nodes vanished, or were as wide as a cell.
TEST(ChannelTables, NarrowSpectraKeepTheirKnots) {
  FlatScene scene;
  scene.channels = {{400, 1400, {}}, {380, 780, {}}, {560, 570, {}}};
  scene.channel_scale.assign(3, 1.0);
  const RegularTable line = table(531.95, 0.05, {0, 1, 0}), box = table(550.1, 0.95, {1, 1}),
                     wide = table(300, 100, {1, 2, 1, 3}, true);
  for (const RegularTable& spectrum : {line, box, wide}) scene.spectra.push_back(row(spectrum));
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {});
  EXPECT_TRUE(t.has_lines);
  const double area[] = {0.05, 0.95};
  for (uint32_t s = 0; s < 2; ++s) {
    EXPECT_EQ(t.tables[s].cells, 0u) << s;
    EXPECT_EQ(t.error[s], 0) << s;
    for (std::size_t k = 0; k < 2; ++k) {
      const Channel& c = scene.channels[k];
      const auto mu = [&](double lambda_nm) { return (lambda_nm - c.min_nm) / c.width_nm(); };
      const double mean = device_mean(t, s, k, mu(531), mu(552)) * c.width_nm();
      EXPECT_NEAR(mean, area[s], 1e-3 * area[s]) << s << " " << k;  // floats of mu: 6e-8 of a channel
    }
    for (const double mu : {0.0, 0.5, 1.0}) EXPECT_EQ(interpolated(t, s, 2, mu), 0) << s;
  }
  EXPECT_GT(t.tables[2].cells, 0u);
  EXPECT_THROW(opencl::make_channel_tables(scene, {}, {.max_line_bytes = 64}), InputError);
}

/// Between 4000 and 4002 nm alone, and continued over the whole channel.
TEST(ChannelTables, NarrowBlackBody) {
  FlatScene scene;
  scene.channels = {{3000, 14000, {}}};
  scene.channel_scale.assign(1, 1.0);
  SpectrumRow thermal;
  thermal.is_planck = thermal.is_emission = true;
  thermal.temperature_k = 800;
  thermal.planck_min_nm = 4000;
  thermal.planck_max_nm = 4002;
  scene.spectra.push_back(thermal);
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {});
  const double mean = device_mean(t, 0, 0, 999.0 / 11000, 1003.0 / 11000);
  EXPECT_NEAR(mean, thermal.planck_scale * planck_radiance(4001, 800) * 2, 2e-3 * mean);
}

TEST(ChannelTables, OrdinaryTablesHaveNoLines) {
  std::mt19937 random(6);
  for (const Layout layout : {Layout::kRegular, Layout::kOverlapping, Layout::kInfrared})
    EXPECT_FALSE(opencl::make_channel_tables(make_device_scene(40, layout, random), {}).has_lines);
}

TEST(ChannelTables, FitTheirBudget) {
  std::mt19937 random(3);
  const FlatScene scene = make_scene(make_channels(30, Layout::kOverlapping, random), random);
  opencl::ChannelTableOptions options;
  options.max_bytes = 1u << 20;
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {}, options);
  EXPECT_LE(t.nodes.size() * sizeof(float), options.max_bytes);
  EXPECT_GT(t.nodes.size() * sizeof(float), options.max_bytes / 4);
}

TEST(ChannelTables, RowsOfMaterials) {
  std::mt19937 random(4);
  const FlatScene scene = make_device_scene(16, Layout::kRegular, random);
  const opencl::ChannelTables t = opencl::make_channel_tables(scene, {});
  EXPECT_EQ(t.material_rows[5], KB_NONE);
  EXPECT_EQ(t.material_rows[6], KB_NONE);
  const double lambda = scene.channels[3].min_nm;
  const auto value = [&](uint32_t s) { return scene.spectra[s].table(lambda); };
  const KbMaterial& metal = scene.materials[1];
  EXPECT_NEAR(interpolated(t, t.material_rows[1], 3, 0), value(metal.eta_row) - 1, 1e-5);
  EXPECT_NEAR(interpolated(t, t.material_rows[1] + 1, 3, 0), value(metal.k_row), 1e-5);
  const KbMaterial& glass = scene.materials[3];
  EXPECT_NEAR(interpolated(t, t.material_rows[3], 3, 0), value(glass.eta_row) / value(glass.ext_row) - 1,
              1e-6);
  EXPECT_NEAR(interpolated(t, t.layout.wavelength_row, 3, 0), lambda - 595, 1e-4);
}

TEST(ChannelCover, IsExactForEveryOffset) {
  std::mt19937 random(5);
  const ChannelList channels = make_channels(60, Layout::kOverlapping, random);
  const opencl::ChannelCover cover = opencl::make_channel_cover(channels, 1 << 20);
  ASSERT_TRUE(cover.overlapping);
  const auto counted = [&](std::size_t k, float mu) {
    const double lambda = (1 - static_cast<double>(mu)) * channels[k].min_nm + mu * channels[k].max_nm;
    double sum = 0;
    for (const Channel& c : channels)
      if (c.min_nm <= lambda && lambda < c.max_nm) sum += 1 / c.width_nm();
    return static_cast<float>(std::max(1.0, channels[k].width_nm() * sum));
  };
  const auto looked_up = [&](std::size_t k, float mu) {
    float value = cover.cover[k].divisor;
    for (kb_u32 i = cover.cover[k].first; i < cover.cover[k + 1].first; ++i)
      if (cover.breaks[i].mu <= mu) value = cover.breaks[i].divisor;
    return value;
  };
  for (std::size_t k = 0; k < channels.size(); ++k) {
    EXPECT_EQ(looked_up(k, 0), counted(k, 0));
    for (int i = 0; i < 50; ++i) {
      const float mu = static_cast<float>(random() >> 8) * 0x1p-24f;
      EXPECT_EQ(looked_up(k, mu), counted(k, mu)) << k << " " << mu;
    }
    for (kb_u32 i = cover.cover[k].first; i < cover.cover[k + 1].first; ++i) {
      const float mu = cover.breaks[i].mu;
      for (float near : {mu, std::nextafter(mu, 0.0f), std::nextafter(mu, 1.0f)}) {
        if (near < 1) {
          EXPECT_EQ(looked_up(k, near), counted(k, near)) << k << " " << near;
        }
      }
    }
  }
  EXPECT_FALSE(opencl::make_channel_cover(make_channels(60, Layout::kRegular, random), 0).overlapping);
  EXPECT_THROW(opencl::make_channel_cover(channels, 64), InputError);
}

}  // namespace
}  // namespace kiloband::test::channel_tables_test
