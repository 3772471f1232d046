#include "device_scene.hpp"

#include <algorithm>
#include <cmath>

#include "validation/oracle/evaluate_reference.hpp"

namespace kiloband::test {
namespace {

uint32_t below(std::mt19937& random, std::size_t n) {
  return static_cast<uint32_t>(random() % n);
}

/// Values at steps of a simple fraction of the channels' width, over all channels and beyond,
/// or ending at an edge.
RegularTable stepped_table(const ChannelList& channels, double low, double high, bool extrapolate,
                           std::mt19937& random) {
  const double width = channels.front().width_nm();
  const double steps[] = {width / 4, width / 3, width / 2, width, 1.25 * width};
  const double step = steps[below(random, 5)];
  const Channel range = hull(channels);
  const bool ends_inside = !extrapolate && channels.size() > 3 && step == width;
  RegularTable out =
      table(ends_inside ? range.min_nm + width : range.min_nm - 2 * step, step, {}, extrapolate);
  const double end_nm = ends_inside ? range.max_nm - 1.5 * width : range.max_nm + 0.5 * step;
  std::uniform_real_distribution<double> uniform(low, high);
  do {
    out.values.push_back(uniform(random));
  } while (out.min_nm + step * static_cast<double>(out.values.size() - 1) < end_nm || out.values.size() < 2);
  return out;
}

RegularTable straight_table(const ChannelList& channels, double low, double high, std::mt19937& random) {
  const Channel range = hull(channels);
  std::uniform_real_distribution<double> uniform(low, high);
  return table(range.min_nm - 1, range.width_nm() + 2, {uniform(random), uniform(random)}, true);
}

void set_material_types(FlatScene& scene) {
  for (uint32_t m = 0; m < 3; ++m) scene.materials[m].type = KB_MATERIAL_CONDUCTOR;
  for (uint32_t m = 3; m < 5; ++m) {
    scene.materials[m].type = KB_MATERIAL_DIELECTRIC;
    scene.materials[m].flags |= KB_MATERIAL_DISPERSIVE;
  }
  scene.materials[7].type = KB_MATERIAL_DIELECTRIC;
  scene.materials[7].flags |= KB_MATERIAL_DISPERSIVE;
  scene.materials[5].type = KB_MATERIAL_CONDUCTOR;
  scene.materials[6].type = KB_MATERIAL_PLASTIC;
}

/// Centres and edges on simple fractions of equal channels, or, for other channels, two centres that enclose
/// them all and the rest beyond: device tables are then exact.
void place_bands(BandSet& set, const ChannelList& channels, bool equal, std::mt19937& random) {
  const Channel range = hull(channels);
  const double width = channels.front().width_nm();
  double nm = equal ? range.min_nm + width / 2 : range.min_nm - 1;
  for (double& centre : set.centres_nm) {
    centre = nm;
    nm = equal ? nm + width / 4 * (1 + below(random, 6)) : std::max(nm, range.max_nm) + 1;
  }
  set.extrapolate |= !equal;
  set.min_nm = range.min_nm;
  set.max_nm = range.min_nm + width * std::ceil((set.centres_nm.back() - range.min_nm) / width);
}

}  // namespace

FlatScene make_device_scene(std::size_t count, Layout layout, std::mt19937& random) {
  const ChannelList channels = make_channels(count, layout, random);
  FlatScene scene = make_scene(channels, random);
  const bool equal = layout == Layout::kRegular || layout == Layout::kInfrared;
  for (SpectrumRow& s : scene.spectra) {
    s.planck_max_nm = 1e300;
    if (s.is_planck) continue;
    const auto [low, high] = std::ranges::minmax(s.table.values);
    s.table = equal ? stepped_table(channels, low, high, s.table.extrapolate, random)
                    : straight_table(channels, low, high, random);
  }
  for (BandSet& set : scene.band_sets) place_bands(set, channels, equal, random);
  set_material_types(scene);
  return scene;
}

RoundOfPaths make_round(const PathBuffer& paths, uint32_t pixels, uint32_t samples, std::mt19937& random) {
  RoundOfPaths round;
  round.pixels = pixels;
  round.samples = samples;
  round.first_index = 12;
  round.blocks = 2;
  for (uint32_t job = 0; job < pixels * samples; ++job) {
    const uint32_t dice = below(random, 10);
    round.path.push_back(dice == 0   ? RoundOfPaths::kEmpty
                         : dice == 1 ? RoundOfPaths::kInvalid
                                     : job % static_cast<uint32_t>(paths.paths.size()));
  }
  for (uint32_t p = 0; p < pixels; ++p) round.block.push_back(p < pixels / 2 ? 0 : 1);
  for (uint32_t t = 0; t < round.blocks * samples; ++t)
    round.mu.push_back(static_cast<float>(random() >> 8) * 0x1p-24f);
  return round;
}

Expected reference(const FlatScene& scene, const DerivedChannels& derived,
                   const opencl::ChannelTables& tables, const PathBuffer& paths, const RoundOfPaths& round,
                   bool per_path) {
  const std::size_t channels = scene.channels.size(), columns = channels + derived.responses.size();
  Expected out;
  out.means.assign(round.pixels * columns, 0);
  out.magnitude.assign(round.pixels * columns, 0);
  out.counts.assign(round.pixels, 0);
  for (uint32_t job = 0; job < round.path.size(); ++job) {
    const uint32_t pixel = job % round.pixels, sample = job / round.pixels;
    if (round.path[job] == RoundOfPaths::kInvalid) continue;
    ++out.counts[pixel];
    if (round.path[job] == RoundOfPaths::kEmpty) continue;
    const double mu =
        per_path ? per_path_mu(round, pixel, sample) : round.mu[round.block[pixel] * round.samples + sample];
    const std::vector<double> values = evaluate_path_reference(scene, derived, paths, round.path[job], mu);
    std::vector<double> largest = values;
    for (double other : {0.0, 0.5, 1.0 - 0x1p-24}) {
      const std::vector<double> there =
          evaluate_path_reference(scene, derived, paths, round.path[job], other);
      for (std::size_t i = 0; i < columns; ++i) largest[i] = std::max(largest[i], there[i]);
    }
    for (std::size_t i = 0; i < columns; ++i) {
      out.means[pixel * columns + i] += values[i];
      out.magnitude[pixel * columns + i] += largest[i];
    }
  }
  for (std::size_t i = 0; i < out.means.size(); ++i) {
    const std::size_t column = i % columns;
    const double scale =
        column < channels ? scene.channel_scale[column] : tables.derived_scale[column - channels];
    const double count = std::max(1u, out.counts[i / columns]);
    out.means[i] /= scale * count;
    out.magnitude[i] = out.magnitude[i] / (scale * count) + 1e-30;
  }
  return out;
}

double largest_error(const std::vector<float>& values, const Expected& expected) {
  double largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double error = std::abs(values[i] - expected.means[i]) / expected.magnitude[i];
    if (!(error <= largest)) largest = error;
  }
  return largest;
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b,
                          const Expected& expected) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double error = std::abs(static_cast<double>(a[i]) - b[i]) / expected.magnitude[i];
    if (!(error <= largest)) largest = error;
  }
  return largest;
}

std::string build_name(const testing::TestParamInfo<EvaluatorBuild>& info) {
  const EvaluatorBuild& b = info.param;
  return "width" + std::to_string(b.width) + "x" + std::to_string(b.vectors) +
         (b.per_path ? "_per_path" : "_shared") + (b.transposed ? "_transposed" : "") +
         (b.tile > 1 ? "_tile" + std::to_string(b.tile) : "");
}

}  // namespace kiloband::test
