#include "validation/speed/subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/opencl_backend.hpp"

namespace kiloband::speed {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kAllBackends = 4;  // fewer are named in commands

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

const std::atomic<bool>& stop_of(const Watch& watch) {
  static const std::atomic<bool> kNever{false};
  return watch.stop ? *watch.stop : kNever;
}

SamplingSettings sampling_of(const Setup& setup, uint32_t replicates, uint64_t seed) {
  SamplingSettings sampling;
  sampling.wavelengths = setup.wavelengths == "per-path" ? WavelengthMode::kPerPath : WavelengthMode::kShared;
  sampling.sampler = setup.sampler == "independent" ? SamplerType::kIndependent : SamplerType::kSobol;
  sampling.rough_dispersion =
      setup.dispersion == "degrade" ? RoughDispersion::kDegrade : RoughDispersion::kSpectralMis;
  sampling.seed = seed;
  sampling.replicates = replicates;
  return sampling;
}

std::unique_ptr<Backend> make_backend(const Settings& settings, const Setup& setup,
                                      const std::shared_ptr<const FlatScene>& scene,
                                      const SamplingSettings& sampling) {
  if (setup.backend == "cpu") return cpu::make_backend(scene, {}, sampling, {});
  opencl::Options options;
  options.device = settings.device;
  options.method = opencl::find_method(setup.method);
  if (setup.pool > 0) {
    options.tuning.pool_slots = setup.pool;
    options.device_memory = settings.device_memory;
  }
  return opencl::make_backend(scene, {}, sampling, options);
}

/// Mean over the replicates of one image, weighted by their samples.
std::vector<float> image_of(const SpectralFilm& film, uint32_t first, uint32_t count,
                            const std::vector<double>& scale) {
  const std::size_t pixels = film.rect().pixels(), channels = scale.size();
  std::vector<float> image(pixels * channels), means(channels);
  std::vector<double> sums(channels);
  for (std::size_t p = 0; p < pixels; ++p) {
    std::ranges::fill(sums, 0.0);
    uint64_t samples = 0;
    for (uint32_t r = first; r < first + count; ++r) {
      const uint64_t own = film.replicate_samples(r, p);
      if (own == 0) continue;
      film.replicate_mean(r, p, means);
      for (std::size_t c = 0; c < channels; ++c) sums[c] += static_cast<double>(own) * means[c];
      samples += own;
    }
    for (std::size_t c = 0; c < channels; ++c)
      image[p * channels + c] = static_cast<float>(sums[c] * scale[c] / static_cast<double>(samples));
  }
  return image;
}

}  // namespace

std::vector<SceneFile> bench_scenes(const Settings& settings) {
  const fs::path own = settings.root / "validation/scenes";
  std::vector<SceneFile> scenes{
      {"cornell_box", settings.root / "scenes/cornell_box/cornell_box.xml", 400, 700, {}},
      {"flint_ball", own / "flint_ball.xml", 400, 700, {}},
      {"metals_and_lamps", own / "metals_and_lamps.xml", 400, 700, {}},
      {"lens_and_glass", own / "lens_and_glass.xml", 400, 700, {}}};
  if (settings.data.empty()) return scenes;
  scenes.push_back({"matpreview", settings.data / "scenes/mitsuba/matpreview/matpreview.xml", 400, 700, {}});
  scenes.push_back({"conference", own / "real/conference.xml", 400, 700, {{"data", settings.data.string()}}});
  std::erase_if(scenes, [](const SceneFile& scene) { return !fs::exists(scene.file); });
  return scenes;
}

SceneFile bench_scene(const Settings& settings, const std::string& name) {
  const auto scenes = bench_scenes(settings);
  const auto found = std::ranges::find(scenes, name, &SceneFile::name);
  if (found == scenes.end()) throw std::logic_error("no bench scene " + name);
  return *found;
}

uint32_t image_side(bool gpu, bool quick, uint32_t channels) {
  if (!gpu) return quick ? 64 : 128;
  constexpr uint64_t kMostValues = uint64_t{1} << 27;
  uint32_t side = quick ? 256 : 512;
  while (side > 64 && uint64_t{side} * side * channels > kMostValues) side /= 2;
  return side;
}

uint32_t image_side(const Bench& bench, uint32_t channels) {
  const Settings& settings = bench.settings();
  const bool gpu =
      settings.opencl() && opencl::select_device(settings.device).type == opencl::DeviceType::kGpu;
  return image_side(gpu, bench.quick(), channels);
}

std::string bands_text(const SceneFile& scene, uint32_t channels) {
  return fmt::format("{:g}:{:g}:{}", scene.first_nm, scene.last_nm, channels);
}

std::string bands_text(const SceneFile& scene, uint32_t channels, uint32_t first, uint32_t count) {
  const double width = (scene.last_nm - scene.first_nm) / channels;
  return fmt::format("{}:{}:{}", scene.first_nm + width * first, scene.first_nm + width * (first + count),
                     count);
}

std::shared_ptr<const FlatScene> load(const SceneFile& scene, const Setup& setup, const std::string& bands) {
  ReadOptions options;
  options.defines = scene.defines;
  options.film_size = {setup.width, setup.height};
  SceneDescription description = read_scene(scene.file, options);
  if (setup.depth != 0) description.integrator.max_depth = setup.depth;
  const ChannelList channels = parse_channels(bands.empty() ? bands_text(scene, setup.channels) : bands);
  return compile_scene(description, {channels, channels, {}});
}

Subject make_subject(const Settings& settings, const Setup& setup, std::shared_ptr<const FlatScene> scene,
                     uint32_t replicates, uint64_t seed) {
  auto backend = make_backend(settings, setup, scene, sampling_of(setup, replicates, seed));
  return {std::move(scene), std::move(backend)};
}

std::string render_command(const Settings& settings, const SceneFile& scene, const Setup& setup,
                           uint64_t seed, const std::string& extra) {
  const fs::path near = scene.file.lexically_proximate(settings.root);
  const bool inside = !near.empty() && *near.begin() != "..";
  std::string text = "kiloband render " + (inside ? near : scene.file).string();
  for (const auto& [name, value] : scene.defines) text += fmt::format(" -D {}={}", name, value);
  text += fmt::format(" --bands {} --size {}x{} --backend {}", bands_text(scene, setup.channels), setup.width,
                      setup.height, setup.backend);
  if (setup.backend == "opencl") text += " --method " + setup.method;
  if (setup.backend == "opencl" && settings.device) text += " --device " + *settings.device;
  if (setup.depth != 0) text += fmt::format(" --max-depth {}", setup.depth);
  if (!setup.wavelengths.empty()) text += " --wavelengths " + setup.wavelengths;
  if (!setup.sampler.empty()) text += " --sampler " + setup.sampler;
  if (!setup.dispersion.empty()) text += " --rough-dispersion " + setup.dispersion;
  if (setup.replicates > 0) text += fmt::format(" --replicates {}", setup.replicates);
  return text + fmt::format(" --spp {} --seed {}{} -o image.hdr", setup.samples, seed, extra);
}

std::string bench_command(const Settings& settings, const std::string& name) {
  std::string text = "kiloband bench " + name;
  if (settings.quick) text += " --quick";
  text += fmt::format(" --seed {}", settings.seed);
  if (!settings.data.empty()) text += " --data " + settings.data.string();
  if (settings.device) text += " --device " + *settings.device;
  if (settings.backends.size() < kAllBackends)
    text += fmt::format(" --backends {}", fmt::join(settings.backends, ","));
  if (settings.device_memory && name == "pool")
    text += fmt::format(" --device-memory {}", *settings.device_memory);
  return text + " -o DIR";
}

double time_samples(Subject& subject, uint32_t samples, const Watch& watch) {
  SpectralFilm film(validation::film_rect(*subject.scene),
                    {subject.backend->film_scale().size(), 1, false, false});
  const std::vector<uint32_t> blocks = film.all_blocks();
  const auto start = Clock::now();
  subject.backend->render(film, {0, 0, samples}, blocks, stop_of(watch), {});
  return seconds_since(start);
}

double time_frames(Subject& subject, uint32_t frames, const Watch& watch) {
  FilmOptions options{subject.backend->film_scale().size()};
  options.sums = subject.backend->sum_rule();
  SpectralFilm film(validation::film_rect(*subject.scene), options);
  const std::vector<uint32_t> blocks = film.all_blocks();
  subject.backend->render(film, {0, 0, 1}, blocks, stop_of(watch),
                          {});  // the first touches the film's memory
  const auto start = Clock::now();
  for (uint32_t i = 1; i <= frames && !watch.stopped(); ++i)
    subject.backend->render(film, {0, i, 1}, blocks, stop_of(watch), {});
  return seconds_since(start);
}

uint32_t samples_for(Subject& subject, double seconds, uint32_t most, const Watch& watch) {
  time_samples(subject, 1, watch);
  uint32_t samples = std::min(2u, most);
  while (samples < most && !watch.stopped()) {
    const double trial = time_samples(subject, samples, watch);
    if (trial >= seconds / 3)  // short ones say too little of long ones
      return static_cast<uint32_t>(std::clamp(std::round(samples * seconds / trial), 1.0, double{1} * most));
    samples = std::min(4 * samples, most);
  }
  return samples;
}

Repetitions repeat(Subject& subject, const Setup& setup, uint32_t count, const Watch& watch) {
  const std::vector<double> scale = subject.backend->film_scale();
  SpectralFilm film(validation::film_rect(*subject.scene),
                    {scale.size(), count * setup.replicates, true, true});
  const std::vector<uint32_t> blocks = film.all_blocks();
  const ReplicatePlan shares{setup.samples, setup.replicates};
  Repetitions result{setup.width, setup.height, scale.size(), {}, {}};
  for (uint32_t i = 0; i < count; ++i) {
    const auto start = Clock::now();
    for (uint32_t r = 0; r < setup.replicates; ++r) {
      const auto share = static_cast<uint32_t>(shares.size(r));
      subject.backend->render(film, {i * setup.replicates + r, 0, share}, blocks, stop_of(watch), {});
    }
    const double seconds = seconds_since(start);
    if (watch.stopped()) break;
    result.seconds.push_back(seconds);
    result.images.push_back(image_of(film, i * setup.replicates, setup.replicates, scale));
  }
  return result;
}

std::vector<BackendName> bench_backends(const Settings& settings) {
  std::vector<BackendName> names;
  for (const std::string& label : settings.backends) {
    const std::size_t colon = label.find(':');
    names.push_back({label.substr(0, colon), colon == std::string::npos ? "" : label.substr(colon + 1)});
  }
  return names;
}

}  // namespace kiloband::speed
