// Speed of deferred evaluation: ns per channel and vertex, film accumulation and resampling of spectra
// included.
//
// Paths as in a Cornell box: 1024 pixels of a block, one path each, 3 vertices in the mean (a light sample
// and a scattering event each, shadowed now and then), five named reflectances, one tabulated lamp. `shared`
// evaluates one offset per call for all 1024 paths, as the renderer does; `per_path` one offset per path.
#include <benchmark/benchmark.h>
#include <hwy/aligned_allocator.h>

#include <random>
#include <string>

#include "src_cpu/evaluator.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kPixels = 1024;

FlatScene make_scene(std::size_t channels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.1, 0.9);
  FlatScene scene;
  for (std::size_t k = 0; k < channels; ++k) {
    const double step = 400.0 / static_cast<double>(channels);
    scene.channels.push_back(
        {380 + step * static_cast<double>(k), 380 + step * static_cast<double>(k + 1), {}});
  }
  scene.channel_scale.assign(channels, 1.0);
  for (int s = 0; s < 6; ++s) {
    SpectrumRow row;
    row.table = {380, 5, {}, false, 0};
    for (int i = 0; i <= 80; ++i) row.table.values.push_back(uniform(random));
    row.is_emission = s == 5;
    scene.spectra.push_back(row);
  }
  return scene;
}

PathBuffer make_paths() {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.1f, 0.9f);
  std::poisson_distribution<int> extra(2.0);
  PathBuffer paths;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    SavedPath path{static_cast<uint32_t>(paths.slots.size()), 1 + static_cast<uint32_t>(extra(random)),
                   pixel};
    for (uint32_t v = 0; v < path.count; ++v) {
      KbPathVertex vertex{};
      vertex.head = KB_KIND_SCALED | (uniform(random) < 0.75f ? KB_VERTEX_NEE : 0u);
      if (v + 1 < path.count) vertex.head |= KB_VERTEX_SCATTER;
      vertex.row_a = static_cast<uint16_t>(random() % 5);
      vertex.nee_row = 5;
      vertex.nee0 = uniform(random);
      vertex.scatter0 = uniform(random);
      paths.slots.push_back(vertex);
    }
    paths.paths.push_back(path);
  }
  return paths;
}

void evaluate(benchmark::State& state, Isa isa, std::size_t channels, bool shared, bool derived) {
  const FlatScene scene = make_scene(channels);
  const PathBuffer paths = make_paths();
  DerivedChannels responses;
  for (int d = 0; derived && d < 3; ++d) {
    responses.names.push_back(std::string(1, "XYZ"[d]));
    responses.responses.push_back(scene.spectra[static_cast<std::size_t>(d)].table);
  }
  Evaluator evaluator(scene, responses, isa);
  auto sums = hwy::AllocateAligned<float>(kPixels * evaluator.stride());
  const std::span<float> film(sums.get(), kPixels * evaluator.stride());
  std::fill(film.begin(), film.end(), 0.0f);
  std::vector<float> offsets(kPixels);
  std::mt19937 random(3);
  for (auto _ : state) {
    for (float& mu : offsets) mu = std::uniform_real_distribution<float>(0, 1)(random);
    if (shared)
      evaluator.add_shared(paths, offsets[0], film);
    else
      evaluator.add_per_path(paths, offsets, film);
    benchmark::ClobberMemory();
  }
  const double work = static_cast<double>(paths.slots.size() * channels);
  state.counters["s_per_channel_vertex"] =
      benchmark::Counter(work, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void register_all() {
  for (Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!is_available(isa)) continue;
    for (std::size_t channels : {8u, 64u, 512u, 1000u}) {
      for (const auto& [name, shared, derived] :
           {std::tuple("shared", true, false), std::tuple("shared+XYZ", true, true),
            std::tuple("per_path", false, false)}) {
        const std::string title = std::string(name) + "/" + to_string(isa) + "/" + std::to_string(channels);
        benchmark::RegisterBenchmark(
            title.c_str(), [=](benchmark::State& state) { evaluate(state, isa, channels, shared, derived); });
      }
    }
  }
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  kiloband::register_all();
  benchmark::RunSpecifiedBenchmarks();
}
