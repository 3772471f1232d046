// Path generation against the bare ray queries that it contains,
// and whole renders against the number of channels.
//
//   bench_paths --benchmark_repetitions=5 --benchmark_report_aggregates_only=true [SCENE.xml ...]
//
// Scenes that are named are measured besides those of here, at 256x256 pixels.
// Counter paths_per_second. "bare" sends the recorded rays of the same paths through Embree on the same scene: the rate
// of a tracer whose shading and random numbers cost nothing.
//   single   path by path in the order of a scalar tracer (closest hit and shadow ray of each bounce), single rays
//   packets  bounce by bounce: camera rays in coherent packets of 16, secondary rays in packets of 8, shadow rays 16
//   sorted   the same with secondary and shadow rays sorted (not timed) and coherent
//   few      against all triangles, as scenes of few triangles are traced
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>
#include <span>

#include "scene/read/reader.hpp"
#include "src_cpu/block_worker.hpp"
#include "validation/speed/bare_rays.hpp"

namespace kiloband {

using namespace cpu;
namespace {

constexpr uint32_t kSamples = 2;  // per benchmark iteration
constexpr const char* kConferenceScene = R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="6"/></integrator>
  <sensor type="perspective"><float name="fov" value="75"/><float name="near_clip" value="0.01"/>
    <transform name="to_world"><lookat origin="4.3, 1.45, 1.5" target="0, 0.5, -1" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="256"/><integer name="height" value="256"/><rfilter type="box"/></film>
  </sensor>
  <shape type="ply"><string name="filename" value="meshes/conference.ply"/><boolean name="face_normals" value="true"/>
    <transform name="to_world"><scale value="0.003"/></transform>
    <bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value="0.6"/></bsdf></bsdf></shape>
  <shape type="rectangle"><transform name="to_world"><scale value="0.5"/><rotate x="1" angle="90"/>
    <translate x="1" y="1.8" z="-0.5"/></transform><emitter type="area"><spectrum name="radiance" value="10"/></emitter></shape>
</scene>)";

std::filesystem::path data_directory() {
  if (const char* named = std::getenv("KILOBAND_DATA")) return named;
  return std::filesystem::path(KILOBAND_SOURCE_DIR) / ".." / "shared" / "data";
}

/// "cornell" from the repository, a file by its path, others from the folder of public data.
SceneDescription read_bench_scene(const std::string& name) {
  ReadOptions options;
  options.film_size = {256, 256};
  if (name.ends_with(".xml")) return read_scene(name, options);
  if (name == "cornell")
    return read_scene(std::filesystem::path(KILOBAND_SOURCE_DIR) / "scenes/cornell_box/cornell_box.xml");
  if (name == "matpreview") return read_scene(data_directory() / "scenes/mitsuba/matpreview/matpreview.xml");
  return read_scene_text(kConferenceScene, name, data_directory());
}

using Bench = speed::BareScene;

Bench& bench_of(const std::string& name, std::size_t channels) {
  static std::map<std::pair<std::string, std::size_t>, std::unique_ptr<Bench>> cache;
  auto& bench = cache[{name, channels}];
  if (!bench) {
    const ChannelList list = parse_channels("400:700:" + std::to_string(channels));
    bench = std::make_unique<Bench>(compile_scene(read_bench_scene(name), {list, {}, {}}));
  }
  return *bench;
}

void count_paths(benchmark::State& state, std::size_t paths_per_iteration) {
  state.counters["paths_per_second"] = benchmark::Counter(static_cast<double>(paths_per_iteration),
                                                          benchmark::Counter::kIsIterationInvariantRate);
}

void generate(benchmark::State& state, const std::string& name, SamplerType sampler) {
  Bench& bench = bench_of(name, 8);
  SamplingSettings settings;
  settings.sampler = sampler;
  settings.replicates = 1;
  PathTracer tracer(bench.tracer, settings, path_kernels(resolve_isa(Isa::kAuto)));
  PathBuffer paths;
  std::vector<uint32_t> invalid;
  const float mu[1] = {0.5f};
  for (auto _ : state) {
    for (const PixelRect& block : bench.blocks) {
      for (uint32_t s = 0; s < kSamples; ++s) tracer.trace(block, {s, 0, s}, mu, paths, invalid);
    }
    benchmark::DoNotOptimize(paths.entries.data());
  }
  count_paths(state, bench.pixels() * kSamples);
  state.counters["rays_per_path"] =
      static_cast<double>(tracer.rays()) /
      (static_cast<double>(state.iterations()) * static_cast<double>(bench.pixels() * kSamples));
}

void bare(benchmark::State& state, const std::string& name) {
  const speed::BareSingles rays(bench_of(name, 8));
  for (auto _ : state) benchmark::DoNotOptimize(rays.query());
  count_paths(state, bench_of(name, 8).pixels());
}

void bare_packets(benchmark::State& state, const std::string& name, speed::BareWay way) {
  const speed::BarePackets rays(bench_of(name, 8), way);
  for (auto _ : state) rays.query();
  count_paths(state, bench_of(name, 8).pixels());
}

void render(benchmark::State& state, bool variance, WavelengthMode wavelengths) {
  Bench& bench = bench_of("cornell", static_cast<std::size_t>(state.range(0)));
  SamplingSettings settings;
  settings.replicates = variance ? 16 : 1;
  settings.wavelengths = wavelengths;
  BlockWorker worker(bench.tracer, {}, settings, resolve_isa(Isa::kAuto));
  const std::atomic<bool> stop{false};
  constexpr uint32_t kSpp = 64;
  for (auto _ : state) {
    SpectralFilm film({0, 0, 64, 64},
                      {bench.compiled->channels.size(), settings.replicates, variance, false});
    for (uint32_t r = 0; r < settings.replicates; ++r) {
      for (uint32_t b = 0; b < film.blocks().size(); ++b) {
        film.add(worker.render(film.blocks()[b], b, {r, 0, kSpp / settings.replicates}, stop,
                               {[](uint64_t) {}, [](const InvalidSample&) {}}));
      }
    }
  }
  count_paths(state, 64 * 64 * kSpp);
}

/// What a viewer does: sample after sample of all pixels, of a film that keeps sums.
void frames(benchmark::State& state, const std::string& name) {
  Bench& bench = bench_of(name, static_cast<std::size_t>(state.range(0)));
  SamplingSettings settings;
  settings.replicates = 1;
  BlockWorker worker(bench.tracer, {}, settings, resolve_isa(Isa::kAuto));
  const std::atomic<bool> stop{false};
  FilmOptions options{bench.compiled->channels.size()};
  options.sums = BlockWorker::sum_rule();
  SpectralFilm film({0, 0, bench.compiled->film.crop_width, bench.compiled->film.crop_height}, options);
  uint32_t sample = 0;
  const auto render_frame = [&] {
    for (uint32_t b = 0; b < film.blocks().size(); ++b)
      worker.go_on(film, b, {0, sample, 1}, stop, {[](uint64_t) {}, [](const InvalidSample&) {}});
    ++sample;
  };
  while (sample < 70) render_frame();  // there are closed sums then
  for (auto _ : state) render_frame();
  count_paths(state, bench.pixels());
}

/// files: of more scenes
void register_all(std::span<char*> files) {
  std::vector<std::string> names{"cornell"};
  if (std::filesystem::exists(data_directory() / "meshes" / "conference.ply"))
    names.insert(names.end(), {"conference", "matpreview"});
  names.insert(names.end(), files.begin(), files.end());
  benchmark::RegisterBenchmark("bare/cornell/few", bare_packets, "cornell", speed::BareWay::kFew);
  for (const std::string& name : names) {
    benchmark::RegisterBenchmark(("frames/" + name).c_str(), frames, name)->Arg(8)->Arg(100);
    benchmark::RegisterBenchmark(("bare/" + name + "/single").c_str(), bare, name);
    benchmark::RegisterBenchmark(("bare/" + name + "/packets").c_str(), bare_packets, name,
                                 speed::BareWay::kPackets);
    benchmark::RegisterBenchmark(("bare/" + name + "/sorted").c_str(), bare_packets, name,
                                 speed::BareWay::kSorted);
    benchmark::RegisterBenchmark(("paths/" + name + "/independent").c_str(), generate, name,
                                 SamplerType::kIndependent);
    benchmark::RegisterBenchmark(("paths/" + name + "/sobol").c_str(), generate, name, SamplerType::kSobol);
  }
  benchmark::RegisterBenchmark("render/shared", render, false, WavelengthMode::kShared)
      ->Arg(8)
      ->Arg(64)
      ->Arg(512)
      ->Arg(1000);
  benchmark::RegisterBenchmark("render/shared-variance", render, true, WavelengthMode::kShared)
      ->Arg(8)
      ->Arg(512);
  benchmark::RegisterBenchmark("render/per-path", render, false, WavelengthMode::kPerPath)->Arg(8)->Arg(512);
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  kiloband::register_all(std::span(argv + 1, static_cast<std::size_t>(argc - 1)));
  benchmark::RunSpecifiedBenchmarks();
}
