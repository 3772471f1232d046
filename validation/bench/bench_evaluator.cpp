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
#include "validation/bench/synthetic_paths.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kPixels = 1024;

void evaluate(benchmark::State& state, Isa isa, std::size_t channels, bool shared, bool derived) {
  const FlatScene scene = synthetic_scene(channels);
  const PathBuffer paths = synthetic_paths(kPixels, kPixels, 2.0, 0.75f);
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
