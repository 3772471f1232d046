// Paths as in a Cornell box, made up: what the benchmarks of deferred evaluation have in common.
#pragma once

#include <random>

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/path/path_buffer.hpp"

namespace kiloband {

using namespace cpu;

/// Five named reflectances (rows 0-4) and one tabulated lamp (row 5) in `channels` equal
/// channels over 380-780 nm.
inline FlatScene synthetic_scene(std::size_t channels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.1, 0.9);
  FlatScene scene;
  const double step = 400.0 / static_cast<double>(channels);
  for (std::size_t k = 0; k < channels; ++k)
    scene.channels.push_back(
        {380 + step * static_cast<double>(k), 380 + step * static_cast<double>(k + 1), {}});
  scene.channel_scale.assign(channels, 1.0);
  for (int s = 0; s < 6; ++s) {
    SpectrumRow row;
    row.table = {380, 5, {}, true, 0};
    for (int i = 0; i <= 80; ++i) row.table.values.push_back(uniform(random));
    row.is_emission = s == 5;
    scene.spectra.push_back(row);
  }
  return scene;
}

/// `count` paths, path i of pixel i % pixels, of 1 + extra vertices in the mean: a scattering event each, and
/// with probability `lit` a light sample.
inline PathBuffer synthetic_paths(uint32_t count, uint32_t pixels, double extra, float lit) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.1f, 0.9f);
  std::poisson_distribution<int> more(extra);
  PathBuffer paths;
  for (uint32_t path = 0; path < count; ++path) {
    const uint32_t vertices = 1 + static_cast<uint32_t>(more(random));
    paths.paths.push_back({static_cast<uint32_t>(paths.entries.size()), vertices, path % pixels});
    for (uint32_t v = 0; v < vertices; ++v) {
      KbPathVertex vertex{};
      vertex.head = KB_KIND_SCALED | (uniform(random) < lit ? KB_VERTEX_NEE : 0u);
      if (v + 1 < vertices) vertex.head |= KB_VERTEX_SCATTER;
      vertex.row_a = static_cast<uint16_t>(random() % 5);
      vertex.nee_row = 5;
      vertex.nee0 = uniform(random);
      vertex.scatter0 = uniform(random);
      paths.entries.push_back(vertex);
    }
  }
  return paths;
}

}  // namespace kiloband
