// Path generation against the bare ray queries that it contains,
// and whole renders against the number of channels.
//
//   bench_paths --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
//
// Counter paths_per_second. "bare" sends the recorded rays of the same paths through Embree on the same scene: the rate
// of a tracer whose shading and random numbers cost nothing.
//   single   path by path in the order of a scalar tracer (closest hit and shadow ray of each bounce), single rays
//   packets  bounce by bounce: camera rays in coherent packets of 16, secondary rays in packets of 8, shadow rays 16
//   sorted   the same with secondary and shadow rays sorted (not timed) and coherent
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>

#include "scene/read/reader.hpp"
#include "src_cpu/block_worker.hpp"

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

/// "cornell" from the repository, others from the folder of public data.
SceneDescription read_bench_scene(const std::string& name) {
  if (name == "cornell")
    return read_scene(std::filesystem::path(KILOBAND_SOURCE_DIR) / "scenes/cornell_box/cornell_box.xml");
  if (name == "matpreview") return read_scene(data_directory() / "scenes/mitsuba/matpreview/matpreview.xml");
  return read_scene_text(kConferenceScene, name, data_directory());
}

/// A scene made ready once.
struct Bench {
  std::shared_ptr<const FlatScene> compiled;
  std::unique_ptr<EmbreeScene> embree;
  std::vector<TriangleRecord> records;
  std::vector<LightTriangle> lights;
  TracerScene tracer;
  std::vector<PixelRect> blocks;

  Bench(const std::string& name, std::size_t channels) {
    const SceneDescription scene = read_bench_scene(name);
    compiled = compile_scene(scene, {parse_channels("400:700:" + std::to_string(channels)), {}, {}});
    const FlatScene& flat = *compiled;
    embree = std::make_unique<EmbreeScene>(flat, "avx512", 1);
    records = make_triangle_records(flat);
    lights = make_light_triangles(flat);
    tracer = {&flat, embree.get(), records, lights};
    blocks = cut_into_blocks({0, 0, flat.film.crop_width, flat.film.crop_height});
  }
};

Bench& bench_of(const std::string& name, std::size_t channels) {
  static std::map<std::pair<std::string, std::size_t>, std::unique_ptr<Bench>> cache;
  auto& bench = cache[{name, channels}];
  if (!bench) bench = std::make_unique<Bench>(name, channels);
  return *bench;
}

std::size_t pixels_of(const Bench& bench) {
  return std::size_t{bench.compiled->film.crop_width} * bench.compiled->film.crop_height;
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
  count_paths(state, pixels_of(bench) * kSamples);
  state.counters["rays_per_path"] =
      static_cast<double>(tracer.rays()) /
      (static_cast<double>(state.iterations()) * static_cast<double>(pixels_of(bench) * kSamples));
}

/// The recorded rays of all blocks in path order.
struct BareRays {
  std::vector<TraceRay> closest;
  std::vector<ShadowRay> shadow;
  std::vector<uint32_t> order;  // index << 1 | is_shadow
};

void append_in_path_order(const Recording& recording, BareRays& rays) {
  std::vector<std::pair<uint32_t, uint32_t>> keyed;  // (path, order code)
  const auto closest_base = static_cast<uint32_t>(rays.closest.size());
  const auto shadow_base = static_cast<uint32_t>(rays.shadow.size());
  rays.closest.insert(rays.closest.end(), recording.closest.begin(), recording.closest.end());
  rays.shadow.insert(rays.shadow.end(), recording.shadow.begin(), recording.shadow.end());
  for (uint32_t i = 0; i < recording.closest.size(); ++i)
    keyed.push_back({recording.closest_path[i], (closest_base + i) << 1});
  for (uint32_t i = 0; i < recording.shadow.size(); ++i)
    keyed.push_back({recording.shadow_path[i], (shadow_base + i) << 1 | 1});
  std::ranges::stable_sort(keyed, {}, &std::pair<uint32_t, uint32_t>::first);
  for (const auto& [path, code] : keyed) rays.order.push_back(code);
}

/// The bare loop: copies each recorded ray (Embree answers in place) and asks for it.
std::size_t query_all(const EmbreeScene& embree, const BareRays& rays) {
  std::size_t hits = 0;
  for (const uint32_t code : rays.order) {
    if (code & 1) {
      ShadowRay ray = rays.shadow[code >> 1];
      embree.occlusions({&ray, 1});
      hits += ray.occluded();
    } else {
      TraceRay ray = rays.closest[code >> 1];
      embree.closest_hits({&ray, 1}, false);
      hits += ray.shape != KB_NONE;
    }
  }
  return hits;
}

/// The rays of one sample of every block.
/// use(recording): called for each
template <class Use>
void record_rays(const Bench& bench, const Use& use) {
  SamplingSettings settings;
  settings.sampler = SamplerType::kIndependent;
  settings.replicates = 1;
  PathTracer tracer(bench.tracer, settings, path_kernels(resolve_isa(Isa::kAuto)));
  PathBuffer paths;
  std::vector<uint32_t> invalid;
  const float mu[1] = {0.5f};
  for (const PixelRect& block : bench.blocks) {
    Recording recording;
    tracer.record_into(&recording);
    tracer.trace(block, {0, 0, 0}, mu, paths, invalid);
    use(recording);
  }
}

void bare(benchmark::State& state, const std::string& name) {
  Bench& bench = bench_of(name, 8);
  BareRays rays;
  record_rays(bench, [&](const Recording& recording) { append_in_path_order(recording, rays); });
  for (auto _ : state) benchmark::DoNotOptimize(query_all(*bench.embree, rays));
  count_paths(state, pixels_of(bench));
}

/// The rays that a wave traced at once, in the order of their paths, or sorted.
struct BareQueue {
  std::vector<float> columns[8];  // of the queue that traces them
  bool shadow = false, camera = false;

  /// first .. end of `rays`, whose paths are `path`.
  template <class Ray>
  BareQueue(const std::vector<Ray>& rays, const std::vector<uint32_t>& path, std::size_t first,
            std::size_t end, const RayGrid* grid)
      : shadow(std::is_same_v<Ray, ShadowRay>), camera(!shadow && first == 0) {
    std::vector<std::size_t> order(end - first);
    std::iota(order.begin(), order.end(), first);
    std::ranges::sort(order, {}, [&](std::size_t i) { return path[i]; });
    const auto queue = std::make_unique<RayQueue>(), sorted = std::make_unique<RayQueue>();
    for (const std::size_t i : order) {
      const Ray& ray = rays[i];
      const uint32_t n = queue->count++;
      queue->ox[n] = ray.ox, queue->oy[n] = ray.oy, queue->oz[n] = ray.oz, queue->t_min[n] = ray.t_min;
      queue->dx[n] = ray.dx, queue->dy[n] = ray.dy, queue->dz[n] = ray.dz, queue->t_max[n] = ray.t_max;
    }
    const bool sorts = grid && !camera;
    if (sorts) sort_rays(*queue, *grid, *sorted);
    const RayQueue& from = sorts ? *sorted : *queue;
    const float* arrays[8] = {from.ox, from.oy, from.oz, from.dx, from.dy, from.dz, from.t_max, from.t_min};
    for (int c = 0; c < 8; ++c) columns[c].assign(arrays[c], arrays[c] + from.count);
  }

  template <class Queue>
  void load(Queue& queue) const {
    queue.count = static_cast<uint32_t>(columns[0].size());
    float* arrays[7] = {queue.ox, queue.oy, queue.oz, queue.dx, queue.dy, queue.dz, queue.t_max};
    for (int c = 0; c < 7; ++c) std::ranges::copy(columns[c], arrays[c]);
    if constexpr (requires { queue.t_min; }) std::ranges::copy(columns[7], queue.t_min);
  }
};

template <class Ray>
void append_queues(const std::vector<Ray>& rays, const std::vector<uint32_t>& path,
                   const std::vector<std::size_t>& ends, const RayGrid* grid,
                   std::vector<BareQueue>& queues) {
  std::size_t first = 0;
  for (const std::size_t end : ends) {
    if (end > first) queues.emplace_back(rays, path, first, end, grid);
    first = end;
  }
}

void bare_packets(benchmark::State& state, const std::string& name, bool sorted) {
  Bench& bench = bench_of(name, 8);
  const RayGrid* grid = sorted ? &bench.embree->grid() : nullptr;
  std::vector<BareQueue> queues;
  record_rays(bench, [&](const Recording& r) {
    append_queues(r.closest, r.closest_path, r.closest_ends, grid, queues);
    append_queues(r.shadow, r.shadow_path, r.shadow_ends, grid, queues);
  });
  const auto rays = std::make_unique<RayQueue>();
  const auto shadows = std::make_unique<ShadowQueue>();
  for (auto _ : state) {
    for (const BareQueue& queue : queues) {
      const RayPackets packets = sorted || queue.camera ? RayPackets::kCoherent : RayPackets::kIncoherent;
      if (queue.shadow) {
        queue.load(*shadows);
        bench.embree->occlusions(*shadows, packets);
      } else {
        queue.load(*rays);
        bench.embree->closest_hits(*rays, packets);
      }
    }
  }
  count_paths(state, pixels_of(bench));
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
void frames(benchmark::State& state) {
  Bench& bench = bench_of("cornell", static_cast<std::size_t>(state.range(0)));
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
  count_paths(state, pixels_of(bench));
}

void register_all() {
  const bool data = std::filesystem::exists(data_directory() / "meshes" / "conference.ply");
  for (const std::string name : {"cornell", "conference", "matpreview"}) {
    if (name != "cornell" && !data) continue;
    benchmark::RegisterBenchmark(("bare/" + name + "/single").c_str(), bare, name);
    benchmark::RegisterBenchmark(("bare/" + name + "/packets").c_str(), bare_packets, name, false);
    benchmark::RegisterBenchmark(("bare/" + name + "/sorted").c_str(), bare_packets, name, true);
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
  benchmark::RegisterBenchmark("frames", frames)->Arg(8)->Arg(100);
  benchmark::RegisterBenchmark("render/per-path", render, false, WavelengthMode::kPerPath)->Arg(8)->Arg(512);
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  kiloband::register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
