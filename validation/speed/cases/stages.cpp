// Where the time goes, and what part of its limit a stage attains.
//
// CPU, one thread: bare ray queries of the same paths (single, and packets as they are traced), path generation, whole
// renders. Tracing rays is what bare packets take, shading what generation takes beyond, evaluation and film what a render takes beyond.
// Limit: the bare packets. Evaluation alone, of paths that are stored and in the caches, against multiply-adds in registers: 3
// operations per channel and vertex (a factor, a light's product and sum).
//
// OpenCL: seconds of every kernel by profiling events. Evaluation against its limit: pt moves throughput and radiance of every
// channel there and back, 16 bytes per channel and vertex, against a triad over as many bytes as the pool's state; dpept's
// is counted as the CPU's.
#include <algorithm>
#include <chrono>

#include "src_gpu/device/device.hpp"
#include "validation/speed/arithmetic.hpp"
#include "validation/speed/bare_rays.hpp"
#include "validation/speed/cpu_limits.hpp"
#include "validation/speed/device_limits.hpp"
#include "validation/speed/subject.hpp"

namespace kiloband::speed {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kBytesOfPt = 16, kOperations = 3;  // per channel and vertex

Record stage_record(const Bench& bench, const Setup& setup, const std::string& series, const char* quantity,
                    const char* unit, const Estimate& e) {
  Record record;
  record.group = "stages";
  record.setup = setup;
  record.series = series;
  record.quantity = quantity, record.unit = unit;
  record.value = e.value, record.error = e.error;
  record.command = bench_command(bench.settings(), "stages");
  return record;
}

/// Calls work until at least `seconds` have passed, in each of several rounds; nanoseconds per path.
template <class Work>
Estimate time_per_path(const Bench& bench, double paths, const Work& work) {
  work();
  std::vector<double> rounds;
  for (int round = 0; round < bench.pick(2, 5) && !bench.stopped(); ++round) {
    const auto start = Clock::now();
    double calls = 0, seconds = 0;
    do {
      work();
      ++calls;
      seconds = std::chrono::duration<double>(Clock::now() - start).count();
    } while (seconds < bench.pick(0.05, 0.4));
    rounds.push_back(1e9 * seconds / (calls * paths));
  }
  return median_of(rounds);
}

void generate_paths(const BareScene& scene, cpu::PathTracer& tracer) {
  cpu::PathBuffer paths;
  std::vector<uint32_t> invalid;
  const float mu[1] = {0.5f};
  for (const PixelRect& block : scene.blocks) tracer.trace(block, {0, 0, 0}, mu, paths, invalid);
}

void render_blocks(const BareScene& scene, cpu::BlockWorker& worker, uint32_t samples) {
  const std::atomic<bool> never{false};
  SpectralFilm film({0, 0, scene.compiled->film.crop_width, scene.compiled->film.crop_height},
                    {scene.compiled->channels.size(), 1, false, false});
  for (uint32_t b = 0; b < film.blocks().size(); ++b)
    film.add(worker.render(film.blocks()[b], b, {0, 0, samples}, never,
                           {[](uint64_t) {}, [](const InvalidSample&) {}}));
}

/// The paths of one sample of every pixel, and what evaluates them.
struct StoredPaths {
  std::vector<cpu::PathBuffer> blocks;
  double vertices = 0;
  cpu::Evaluator evaluator;
  std::vector<float> sums;  // of a block
  std::vector<float*> rows;

  StoredPaths(const BareScene& scene, cpu::PathTracer& tracer, cpu::Isa isa)
      : evaluator(*scene.compiled, {}, isa), sums(kBlockSize * kBlockSize * evaluator.stride()) {
    for (std::size_t first = 0; first < sums.size(); first += evaluator.stride())
      rows.push_back(&sums[first]);
    std::vector<uint32_t> invalid;
    const float mu[1] = {0.5f};
    for (const PixelRect& block : scene.blocks) {
      cpu::PathBuffer& paths = blocks.emplace_back();
      tracer.trace(block, {0, 0, 0}, mu, paths, invalid);
      for (std::size_t i = 0; i < paths.entries.size(); ++vertices)
        i += 1 + kb_vertex_extensions(paths.entries[i].head);
    }
  }

  void evaluate() {
    for (const cpu::PathBuffer& paths : blocks) evaluator.add_shared(paths, 0.5, {rows, false});
  }
};

Setup cpu_setup(const Bench& bench, const SceneFile& file, uint32_t channels) {
  Setup setup;
  setup.scene = file.name, setup.backend = "cpu", setup.wavelengths = "shared", setup.sampler = "independent";
  setup.channels = channels;
  setup.width = setup.height = image_side(bench, channels);
  setup.replicates = 1;
  return setup;
}

void measure_cpu_evaluation(Bench& bench, const Setup& setup, const BareScene& scene,
                            cpu::PathTracer& tracer) {
  const cpu::Isa isa = cpu::resolve_isa(cpu::Isa::kAuto);
  StoredPaths stored(scene, tracer, isa);
  const auto pixels = static_cast<double>(scene.pixels());
  const Estimate time = time_per_path(bench, pixels, [&] { stored.evaluate(); });
  if (bench.stopped()) return;
  const double operations = kOperations * setup.channels * stored.vertices / pixels;  // per path
  const Estimate rate = ratio_of({1e9 * operations, 0}, time);
  const double peak = peak_flops_of_thread(isa);
  bench.add(stage_record(bench, setup, "evaluation", "operations_per_second", "1/s", rate));
  bench.add(stage_record(bench, setup, "limit", "peak_operations", "1/s", {peak, kNone}));
  bench.add(stage_record(bench, setup, "evaluation", "fraction_of_peak", "", ratio_of(rate, {peak, 0})));
}

void measure_cpu(Bench& bench, const SceneFile& file, uint32_t channels) {
  Setup setup = cpu_setup(bench, file, channels);
  const BareScene scene(load(file, setup));
  SamplingSettings sampling;
  sampling.sampler = SamplerType::kIndependent;
  sampling.replicates = 1;
  const cpu::Isa isa = cpu::resolve_isa(cpu::Isa::kAuto);
  cpu::PathTracer tracer(scene.tracer, sampling, cpu::path_kernels(isa));
  cpu::BlockWorker worker(scene.tracer, {}, sampling, isa);
  const auto pixels = static_cast<double>(scene.pixels());
  const BareSingles singles(scene);
  const BarePackets packets(scene, way_of_paths(scene));
  constexpr uint32_t kSamples = 16;
  const std::vector<std::pair<std::string, Estimate>> stages{
      {"bare rays, single", time_per_path(bench, pixels, [&] { singles.query(); })},
      {"bare rays, packets", time_per_path(bench, pixels, [&] { packets.query(); })},
      {"path generation", time_per_path(bench, pixels, [&] { generate_paths(scene, tracer); })},
      {"render", time_per_path(bench, pixels * kSamples, [&] { render_blocks(scene, worker, kSamples); })}};
  if (bench.stopped()) return;
  for (const auto& [name, time] : stages) {
    Record record = stage_record(bench, setup, name, "time_per_path", "ns", time);
    record.error_kind = "half range", record.repetitions = bench.pick(2u, 5u);
    bench.add(record);
    if (name == "path generation" || name == "render")
      bench.add(
          stage_record(bench, setup, name, "fraction_of_bare_packets", "", ratio_of(stages[1].second, time)));
  }
  measure_cpu_evaluation(bench, setup, scene, tracer);
}

/// Kernels that evaluate, of each method.
bool evaluates(const std::string& kernel) {
  return kernel == "pt_update" || kernel == "dpept_path" || kernel == "dpept_batch";
}

double limit_of(opencl::DeviceContext& context, const Setup& setup, uint32_t slots) {
  if (setup.method != "pt") return peak_flops(context);
  return triad_bandwidth(context, uint64_t{8} * ((setup.channels + 15) / 16 * 16) * slots);
}

void measure_device(Bench& bench, opencl::DeviceContext& context, const SceneFile& file, Setup setup) {
  Subject subject = make_subject(bench.settings(), setup, load(file, setup), 1, bench.settings().seed);
  // The second round of a GPU still has a quarter of the paths in flight that it ends with (src_gpu/path/launch_pace.hpp).
  time_samples(subject, bench.pick(2u, 16u), bench.watch());
  const BackendStatistics before = subject.backend->statistics();
  setup.samples = bench.pick(8u, 64u);
  const double seconds = time_samples(subject, static_cast<uint32_t>(setup.samples), bench.watch());
  if (bench.stopped()) return;
  BackendStatistics after = subject.backend->statistics();
  const auto paths = static_cast<double>(after.paths - before.paths);
  const auto vertices = static_cast<double>(after.vertices - before.vertices);
  double on_device = 0, evaluation = 0;
  const auto add = [&](const std::string& series, const char* quantity, const char* unit, double value) {
    bench.add(stage_record(bench, setup, series, quantity, unit, {value, kNone}));
  };
  for (const auto& [kernel, total] : after.kernel_seconds) {
    const auto earlier = before.kernel_seconds.find(kernel);
    const double own = total - (earlier == before.kernel_seconds.end() ? 0 : earlier->second);
    on_device += own;
    if (evaluates(kernel)) evaluation += own;
    if (own > 0) add(kernel, "time_per_path", "ns", 1e9 * own / paths);
  }
  add("host and transfers", "time_per_path", "ns", 1e9 * std::max(seconds - on_device, 0.0) / paths);
  add("render", "time_per_path", "ns", 1e9 * seconds / paths);
  const bool pt = setup.method == "pt";
  const double padded = pt ? (setup.channels + 15) / 16 * 16 : setup.channels;
  const double attained = (pt ? kBytesOfPt : kOperations) * padded * vertices / evaluation;
  const double limit = limit_of(context, setup, after.pool_slots);
  add("evaluation", pt ? "bytes_per_second" : "operations_per_second", pt ? "B/s" : "1/s", attained);
  add("limit", pt ? "triad_bandwidth" : "peak_operations", pt ? "B/s" : "1/s", limit);
  add("evaluation", pt ? "fraction_of_triad" : "fraction_of_peak", "", attained / limit);
}

}  // namespace

void run_stages(Bench& bench) {
  std::vector<SceneFile> scenes = bench_scenes(bench.settings());
  if (bench.quick()) scenes.resize(1);
  const std::vector<uint32_t> few{8, 256}, many{8, 64, 512};
  const auto& counts = bench.quick() ? few : many;
  double done = 0;
  for (const SceneFile& file : scenes) {
    for (const uint32_t channels : counts) {
      for (const BackendName& name : bench_backends(bench.settings())) {
        if (bench.stopped()) return;
        Setup setup = cpu_setup(bench, file, channels);
        setup.backend = name.backend, setup.method = name.method, setup.sampler = "sobol";
        if (name.backend == "cpu") {
          measure_cpu(bench, file, channels);
          continue;
        }
        opencl::DeviceContext context(opencl::select_device(bench.settings().device), {.profiling = true});
        measure_device(bench, context, file, setup);
      }
      bench.progress(++done / static_cast<double>(scenes.size() * counts.size()));
    }
  }
}

}  // namespace kiloband::speed
