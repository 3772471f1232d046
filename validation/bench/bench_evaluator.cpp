// Speed of deferred evaluation: ns per channel and vertex, film accumulation and resampling
// of spectra included.
//
// Paths as in a Cornell box: 1024 pixels of a block, one path each, 3 vertices in the mean (a light sample
// and a scattering event each, shadowed now and then), five named reflectances, one tabulated lamp. `shared`
// evaluates one offset per call for all 1024 paths, as the renderer does; `per_path` one offset per path. The
// reflectances are rows, or lookups of spectral textures: 200 bands, 1000 bands, mixtures of 4 spectra.
#include <benchmark/benchmark.h>
#include <hwy/aligned_allocator.h>

#include <cstring>
#include <random>
#include <string>

#include "src_cpu/evaluate/evaluator.hpp"
#include "tests/unit/src_cpu/evaluate/following_rows.hpp"
#include "validation/bench/synthetic_paths.hpp"

namespace kiloband {

using namespace cpu;
namespace {

constexpr std::size_t kPixels = 1024;

/// What reflectances are.
enum class Reflectances { kRows, kBands200, kBands1000, kMixtures };

/// 64 x 64 texels: more than the caches of a core hold, if there are many bands.
void add_texture(FlatScene& scene, Reflectances kind) {
  if (kind == Reflectances::kRows) return;
  KbTexture texture{};
  texture.width = texture.height = 64;
  texture.illuminant_row = KB_NONE;
  texture.flags = kind == Reflectances::kMixtures ? KB_TEXTURE_WEIGHTS : KB_TEXTURE_BANDS;
  texture.values = kind == Reflectances::kMixtures ? 4 : kind == Reflectances::kBands200 ? 200 : 1000;
  if (kind != Reflectances::kMixtures) {
    BandSet set;
    const double step = 400.0 / texture.values;
    for (uint32_t b = 0; b < texture.values; ++b) set.centres_nm.push_back(380 + (b + 0.5) * step);
    set.min_nm = 380;
    set.max_nm = 780;
    scene.band_sets.push_back(set);
  }
  const std::size_t count = std::size_t{texture.width} * texture.height * texture.values;
  scene.spectral_texels.push_back(std::make_shared<const std::vector<float>>(count, 0.2f));
  scene.textures.push_back(texture);
}

/// The same paths with every reflectance looked up in texture 0.
PathBuffer textured(const PathBuffer& plain) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(0, 1);
  PathBuffer paths;
  for (const SavedPath& path : plain.paths) {
    paths.paths.push_back({static_cast<uint32_t>(paths.entries.size()), 2 * path.count, path.pixel});
    for (uint32_t v = 0; v < path.count; ++v) {
      KbPathVertex vertex = plain.entries[path.first + v];
      vertex.head |= KB_VERTEX_TEX_A;
      paths.entries.push_back(vertex);
      const auto x = static_cast<uint32_t>(random() % 64), y = static_cast<uint32_t>(random() % 64);
      const KbTextureSample sample{0, x | y << 16, uniform(random), uniform(random)};
      paths.entries.emplace_back();
      std::memcpy(&paths.entries.back(), &sample, sizeof sample);
    }
  }
  return paths;
}

void evaluate(benchmark::State& state, Isa isa, std::size_t channels, bool shared, bool derived,
              Reflectances reflectances) {
  FlatScene scene = synthetic_scene(channels);
  add_texture(scene, reflectances);
  const PathBuffer plain = synthetic_paths(kPixels, kPixels, 2.0, 0.75f);
  const PathBuffer paths = reflectances == Reflectances::kRows ? plain : textured(plain);
  DerivedChannels responses;
  for (int d = 0; derived && d < 3; ++d) {
    responses.names.push_back(std::string(1, "XYZ"[d]));
    responses.responses.push_back(scene.spectra[static_cast<std::size_t>(d)].table);
  }
  Evaluator evaluator(scene, responses, isa);
  auto sums = hwy::AllocateAligned<float>(kPixels * evaluator.stride());
  const std::span<float> film(sums.get(), kPixels * evaluator.stride());
  const test::FollowingRows rows(evaluator, film);
  std::fill(film.begin(), film.end(), 0.0f);
  std::vector<float> offsets(kPixels);
  std::mt19937 random(3);
  for (auto _ : state) {
    for (float& mu : offsets) mu = std::uniform_real_distribution<float>(0, 1)(random);
    if (shared)
      evaluator.add_shared(paths, offsets[0], rows);
    else
      evaluator.add_per_path(paths, offsets, rows);
    benchmark::ClobberMemory();
  }
  const double work = static_cast<double>(plain.entries.size() * channels);
  state.counters["s_per_channel_vertex"] =
      benchmark::Counter(work, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void register_all() {
  for (Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!is_available(isa)) continue;
    for (std::size_t channels : {8u, 64u, 512u, 1000u}) {
      for (const auto& [name, shared, derived, reflectances] :
           {std::tuple("shared", true, false, Reflectances::kRows),
            std::tuple("shared+XYZ", true, true, Reflectances::kRows),
            std::tuple("shared_bands200", true, false, Reflectances::kBands200),
            std::tuple("shared_bands1000", true, false, Reflectances::kBands1000),
            std::tuple("shared_mixtures", true, false, Reflectances::kMixtures),
            std::tuple("per_path", false, false, Reflectances::kRows),
            std::tuple("per_path_bands200", false, false, Reflectances::kBands200),
            std::tuple("per_path_mixtures", false, false, Reflectances::kMixtures)}) {
        const std::string title = std::string(name) + "/" + to_string(isa) + "/" + std::to_string(channels);
        benchmark::RegisterBenchmark(title.c_str(), [=](benchmark::State& state) {
          evaluate(state, isa, channels, shared, derived, reflectances);
        });
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
