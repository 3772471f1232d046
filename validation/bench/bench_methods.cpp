// The three methods of the OpenCL backend against the number of channels, in one run, with a
// model of bytes and operations beside the measurement.
//
//   bench_methods [--device N|NAME] [--pool SLOTS] [--size 128] [--spp 16] [--rounds 3] [--json FILE]
//                 [SCENE.xml]      --pool: of all methods, else each has what it usually has
//
// Paths per second are wall time of whole renders (compiled kernels; median of the rounds). Evaluation is
// device time of the kernels that evaluate (pt_update; dpept_path; dpept_batch) per channel and vertex.
//
// Model. pt reads and writes throughput and radiance of every channel at every bounce: 16 bytes per channel
// and vertex from memory, so 16 / B(state), B(n) being a triad's bandwidth over arrays of n bytes in all.
// dpept keeps both in registers and loads three rows (reflectance, light, and its share of film sums) from
// the cache: 12 / B(cache).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/json_dump.hpp"
#include "film/spectral_film.hpp"
#include "scene/read/reader.hpp"
#include "src_gpu/opencl_backend.hpp"
#include "validation/speed/device_limits.hpp"

namespace kiloband {
namespace {

struct Settings {
  std::string scene = std::string(KILOBAND_SOURCE_DIR) + "/scenes/cornell_box/cornell_box.xml";
  std::optional<std::string> device;
  std::optional<uint32_t> pool;
  uint32_t size = 128, spp = 16, rounds = 3;
  std::optional<std::string> json;
};

/// One render: wall seconds and device seconds of evaluation.
struct Timing {
  double seconds = 0, evaluation = 0, generation = 0;
  double paths = 0, vertices = 0;
  uint32_t slots = 0;  // paths in flight
};

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

double kernel_sum(const std::map<std::string, double>& seconds, std::initializer_list<const char*> names) {
  double sum = 0;
  for (const char* name : names) {
    const auto found = seconds.find(name);
    if (found != seconds.end()) sum += found->second;
  }
  return sum;
}

Timing render_once(Backend& backend, const FlatScene& scene, uint32_t spp) {
  SpectralFilm film({0, 0, scene.film.crop_width, scene.film.crop_height},
                    {scene.channels.size(), 1, false, false});
  const std::vector<uint32_t> blocks = film.all_blocks();
  const BackendStatistics before = backend.statistics();
  const std::atomic<bool> stop{false};
  const double start = seconds_now();
  backend.render(film, {0, 0, spp}, blocks, stop, {});
  Timing timing;
  timing.seconds = seconds_now() - start;
  const BackendStatistics after = backend.statistics();
  const auto spent = [&](std::initializer_list<const char*> names) {
    return kernel_sum(after.kernel_seconds, names) - kernel_sum(before.kernel_seconds, names);
  };
  timing.evaluation = spent({"pt_update", "dpept_path", "dpept_batch"});
  timing.generation =
      spent({"generate", "closest_hits", "shade", "any_hits", "shadow_walks", "whole_bounces", "compact"});
  timing.slots = after.pool_slots;
  timing.paths = static_cast<double>(after.paths - before.paths);
  timing.vertices = static_cast<double>(after.vertices - before.vertices);
  return timing;
}

Timing measure(const std::shared_ptr<const FlatScene>& scene, const Settings& settings,
               opencl::Method method) {
  opencl::Options options;
  options.device = settings.device;
  options.method = method;
  options.tuning.pool_slots = settings.pool;
  SamplingSettings sampling;
  sampling.replicates = 1;
  const auto backend = opencl::make_backend(scene, {}, sampling, options);
  render_once(*backend, *scene, settings.spp);  // compiles the kernels
  std::vector<double> seconds, evaluation, generation;
  Timing timing;
  for (uint32_t i = 0; i < settings.rounds; ++i) {
    timing = render_once(*backend, *scene, settings.spp);
    seconds.push_back(timing.seconds);
    evaluation.push_back(timing.evaluation);
    generation.push_back(timing.generation);
  }
  timing.seconds = median(seconds);
  timing.evaluation = median(evaluation);
  timing.generation = median(generation);
  return timing;
}

std::shared_ptr<const FlatScene> load(const Settings& settings, uint32_t channels) {
  SceneDescription scene = read_scene(settings.scene);
  Film& film = scene.sensor.film;
  film.width = film.height = film.crop_width = film.crop_height = settings.size;
  film.crop_x = film.crop_y = 0;
  return compile_scene(scene, {parse_channels(fmt::format("400:700:{}", channels)), {}, {}});
}

nlohmann::json row(opencl::DeviceContext& context, const Settings& settings, uint32_t channels,
                   double cache) {
  const auto scene = load(settings, channels);
  const Timing pt = measure(scene, settings, opencl::Method::kPt);
  const Timing path = measure(scene, settings, opencl::Method::kDpeptPath);
  const Timing batch = measure(scene, settings, opencl::Method::kDpeptBatch);
  const double padded = (channels + 15) / 16 * 16;
  const double triad = speed::triad_bandwidth(context, static_cast<uint64_t>(8 * padded * pt.slots));
  const auto ns = [&](const Timing& t) { return t.evaluation / (t.vertices * channels) * 1e9; };
  const double bandwidth = 16 * padded * pt.vertices / pt.evaluation;
  nlohmann::json r;
  r["channels"] = channels;
  r["paths_per_second"] = {{"pt", pt.paths / pt.seconds},
                           {"dpept_path", path.paths / path.seconds},
                           {"dpept_batch", batch.paths / batch.seconds}};
  r["paths_in_flight"] = {{"pt", pt.slots}, {"dpept_path", path.slots}, {"dpept_batch", batch.slots}};
  r["evaluation_ns"] = {{"pt", ns(pt)}, {"dpept_path", ns(path)}, {"dpept_batch", ns(batch)}};
  r["generation_share_of_batch"] = batch.generation / batch.seconds;
  r["pt_bandwidth"] = bandwidth;
  r["triad_bandwidth"] = triad;
  r["evaluation_ratio"] = pt.evaluation / batch.evaluation;
  r["evaluation_ratio_model"] = (16 / triad) / (12 / cache);
  r["end_to_end_ratio"] = pt.seconds / batch.seconds;
  fmt::print(
      "{:>5} {:>8.3f} {:>8.3f} {:>8.3f}   {:>7.4f} {:>7.4f} {:>7.4f}   {:>6.1f} {:>6.1f} {:>5.2f}   {:>6.1f} "
      "{:>6.1f} {:>6.2f}\n",
      channels, pt.paths / pt.seconds * 1e-6, path.paths / path.seconds * 1e-6,
      batch.paths / batch.seconds * 1e-6, ns(pt), ns(path), ns(batch), bandwidth * 1e-9, triad * 1e-9,
      bandwidth / triad, pt.evaluation / batch.evaluation, (16 / triad) / (12 / cache),
      pt.seconds / batch.seconds);
  std::fflush(stdout);
  return r;
}

int run(int argc, char** argv) {
  CLI::App app{"The OpenCL backend's methods against the number of channels"};
  Settings settings;
  std::vector<uint32_t> channels{8, 16, 32, 64, 128, 256, 512, 1024};
  app.add_option("scene", settings.scene);
  app.add_option("--device", settings.device);
  app.add_option("--pool", settings.pool)->check(CLI::Range(64u, 1u << 22));
  app.add_option("--size", settings.size)->check(CLI::Range(1u, 4096u));
  app.add_option("--spp", settings.spp)->check(CLI::Range(1u, 4096u));
  app.add_option("--rounds", settings.rounds)->check(CLI::Range(1u, 100u));
  app.add_option("--channels", channels);
  app.add_option("--json", settings.json);
  CLI11_PARSE(app, argc, argv);

  opencl::DeviceContext context(opencl::select_device(settings.device), {.profiling = true});
  const double cache = speed::triad_bandwidth(context, 3 * 8192);
  nlohmann::json json;
  json["device"] = context.device().name;
  json["driver"] = context.device().driver_version;
  json["image"] = fmt::format("{0} x {0} pixels, {1} samples", settings.size, settings.spp);
  json["triad_in_cache"] = cache;
  fmt::print("{}; a triad in the cache: {:.0f} GB/s\n", context.device().name, cache * 1e-9);
  fmt::print("{:>5} {:^26}   {:^23}   {:^19}   {:^20}\n", "", "Mpaths/s", "evaluation, ns", "GB/s",
             "batch over pt");
  fmt::print("{:>5} {:>8} {:>8} {:>8}   {:>7} {:>7} {:>7}   {:>6} {:>6} {:>5}   {:>6} {:>6} {:>6}\n", "K",
             "pt", "path", "batch", "pt", "path", "batch", "pt", "triad", "ratio", "eval", "model", "all");
  for (const uint32_t k : channels) json["rows"].push_back(row(context, settings, k, cache));
  if (settings.json) std::ofstream(*settings.json) << dump_json(json, 2) << "\n";
  return 0;
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  return kiloband::run(argc, argv);
}
