#include "random_gas.hpp"

#include <array>
#include <cmath>
#include <cstring>

namespace kiloband::test {
namespace {

constexpr double kHottest = 3000;
constexpr uint16_t kGasRows = 3;

uint16_t first_row(const FlatScene& scene) {
  return static_cast<uint16_t>(scene.spectra.size() - kGasRows - 1);
}

/// 30 lines over the channels, and a little between them, 1/m.
Spectrum lines(const ChannelList& channels, std::mt19937& random) {
  const Channel range = hull(channels);
  std::vector<double> lambda_nm, value;
  double at = range.min_nm;
  while (at < range.max_nm) {
    at += uniform(random, 0.01, 0.05) * range.width_nm();
    lambda_nm.push_back(at);
    value.push_back(lambda_nm.size() % 2 ? uniform(random, 0.2, 1) : uniform(random, 1e-3, 0.1));
  }
  return Spectrum::tabulated(lambda_nm, value, true);
}

/// A column in m for an optical depth of up to 30.
float column(std::mt19937& random) {
  return static_cast<float>(std::pow(10, uniform(random, -8, 1.47)));
}

uint16_t gas_row(const FlatScene& scene, std::mt19937& random) {
  return static_cast<uint16_t>(first_row(scene) + random() % kGasRows);
}

KbPathVertex gas_vertex(const FlatScene& scene, uint32_t flags, std::mt19937& random) {
  KbPathVertex v{};
  v.head = KB_KIND_MEDIUM | flags;
  v.row_a = gas_row(scene, random);
  v.emit_row = static_cast<uint16_t>(scene.spectra.size() - 1);
  v.emit_weight = 1;
  v.scatter0 = column(random);
  return v;
}

void add_segment(const FlatScene& scene, PathBuffer& paths, std::mt19937& random) {
  const bool emits = random() % 3 != 0;
  paths.entries.push_back(gas_vertex(scene, KB_VERTEX_SCATTER | (emits ? KB_VERTEX_EMIT : 0), random));
}

void add_aside(const FlatScene& scene, PathBuffer& paths, std::mt19937& random) {
  paths.entries.push_back(gas_vertex(scene, KB_VERTEX_DEFER, random));
  paths.entries.back().scatter0 = static_cast<float>(uniform(random, 0, 3));
  paths.entries.push_back(gas_vertex(scene, KB_VERTEX_SCATTER | KB_VERTEX_EMIT, random));
}

/// A diffuse vertex whose light passes one or two gases.
void add_light(const FlatScene& scene, PathBuffer& paths, std::mt19937& random) {
  KbPathVertex v{};
  v.head = KB_KIND_SCALED | KB_VERTEX_NEE | KB_VERTEX_SCATTER | KB_VERTEX_DEFER;
  v.row_a = 1;
  v.nee_row = 8;
  v.nee0 = static_cast<float>(uniform(random, 0.1, 1));
  v.scatter0 = static_cast<float>(uniform(random, 0.5, 2));
  paths.entries.push_back(v);
  for (uint32_t left = 1 + random() % 2; left-- > 0;) {
    KbPathVertex gas = gas_vertex(scene, KB_VERTEX_NEE | (left > 0 ? KB_VERTEX_DEFER : 0), random);
    gas.nee0 = static_cast<float>(uniform(random, 0, 4));
    paths.entries.push_back(gas);
  }
}

void add_plume(const FlatScene& scene, PathBuffer& paths, std::mt19937& random) {
  const uint32_t cells = 1 + random() % 8;
  KbPathVertex v = gas_vertex(scene, KB_VERTEX_SCATTER | KB_VERTEX_EMIT, random);
  v.head |= cells << KB_VERTEX_MATERIAL_SHIFT;
  v.scatter0 = 0;
  v.nee0 = static_cast<float>(uniform(random, 0.7 * kHottest, kHottest));
  v.nee1 = kHottest;
  KbPlumeCell list[8];
  for (KbPlumeCell& cell : list) {
    cell = {column(random), static_cast<float>(uniform(random, 0.7 * kHottest, kHottest))};
    v.scatter0 += cell.column;
  }
  paths.entries.push_back(v);
  const std::size_t first = paths.entries.size();
  paths.entries.resize(first + kb_vertex_extensions(v.head));
  std::memcpy(static_cast<void*>(&paths.entries[first]), list, cells * sizeof(KbPlumeCell));
}

}  // namespace

void add_gas(FlatScene& scene, std::mt19937& random) {
  for (uint16_t i = 0; i < kGasRows; ++i) {
    ChannelKnots knots = sampled_knots(lines(scene.channels, random), scene.channels, "gas");
    if (i == 1) knots = sorted_knots(knots);
    SpectrumRow row;
    row.absorption = std::make_shared<const ChannelKnots>(std::move(knots));
    scene.spectra.push_back(std::move(row));
  }
  SpectrumRow hot;
  hot.is_planck = hot.is_emission = true;
  hot.temperature_k = kHottest;
  scene.spectra.push_back(hot);
  scene.features.gas = scene.features.plume = true;
}

PathBuffer make_gas_paths(const FlatScene& scene, std::size_t count, std::mt19937& random) {
  constexpr std::array kAdd = {add_segment, add_aside, add_light, add_plume};
  PathBuffer paths;
  for (uint32_t p = 0; p < count; ++p) {
    const auto first = static_cast<uint32_t>(paths.entries.size());
    for (uint32_t v = 0, n = 1 + random() % 4; v < n; ++v) {
      kAdd[random() % kAdd.size()](scene, paths, random);
      const PathBuffer other = make_paths(scene, 1, random);
      const KbPathVertex& head = other.entries.front();
      if (random() % 2)
        paths.entries.insert(paths.entries.end(), other.entries.begin(),
                             other.entries.begin() + 1 + kb_vertex_extensions(head.head));
    }
    paths.paths.push_back({first, static_cast<uint32_t>(paths.entries.size()) - first, p});
  }
  return paths;
}

}  // namespace kiloband::test
