#include "validation/suite/rendering.hpp"

#include <chrono>
#include <stdexcept>

#include "film/spectral_film.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/opencl_backend.hpp"

namespace kiloband::validation {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

std::string Configuration::label() const {
  std::string text = backend;
  text += wavelengths == WavelengthMode::kShared ? " shared" : " per-path";
  text += sampler == SamplerType::kSobol ? " sobol" : " independent";
  if (rough_dispersion == RoughDispersion::kDegrade) text += " degrade";
  return text;
}

std::shared_ptr<const FlatScene> load(const CaseScene& scene) {
  ReadOptions options;
  options.defines = scene.defines;
  if (scene.width > 0) options.film_size = {scene.width, scene.height};
  const SceneDescription description = read_scene(scene.file, options);
  const ChannelList& own = description.sensor.film.channels;
  const ChannelList channels = !scene.bands.empty() || own.empty()
                                   ? parse_channels(scene.bands.empty() ? "400:700:12" : scene.bands)
                                   : own;
  return compile_scene(description, {channels, channels, {}});
}

const BackendRegistry& backends() {
  static const BackendRegistry kBackends({cpu::backend_entry(), opencl::backend_entry()});
  return kBackends;
}

std::unique_ptr<Backend> make_backend(const Configuration& configuration,
                                      const std::shared_ptr<const FlatScene>& scene,
                                      const SamplingSettings& settings) {
  BackendRequest request;
  request.backend = configuration.backend;
  request.specialised = configuration.specialised;
  return backends().make(request, {scene, {}, settings});
}

stats::ReplicateImage image_of(const SpectralFilm& film, const PixelRect& rect, uint32_t replicates,
                               const std::vector<double>& scale) {
  stats::ReplicateImage image{rect.width, rect.height, scale.size(), replicates, {}, {}};
  image.means.reserve(std::size_t{replicates} * rect.pixels() * scale.size());
  std::vector<float> means(scale.size());
  for (uint32_t r = 0; r < replicates; ++r) {
    for (std::size_t pixel = 0; pixel < rect.pixels(); ++pixel) {
      film.replicate_mean(r, pixel, means);
      for (std::size_t c = 0; c < scale.size(); ++c)
        image.means.push_back(static_cast<float>(means[c] * scale[c]));
      image.samples.push_back(film.replicate_samples(r, pixel));
    }
  }
  return image;
}

void render_replicates(Backend& backend, SpectralFilm& film, uint32_t replicates, uint32_t samples,
                       const Watch& watch) {
  const std::vector<uint32_t> blocks = film.all_blocks();
  static const std::atomic<bool> never{false};
  for (uint32_t r = 0; r < replicates && !watch.stopped(); ++r) {
    backend.render(film, {r, 0, samples}, blocks, watch.stop ? *watch.stop : never, {});
    if (watch.progress) watch.progress((r + 1.0) / replicates);
  }
}

Rendering render(const std::shared_ptr<const FlatScene>& scene, const Configuration& configuration,
                 const Sampling& sampling, const Watch& watch) {
  const auto backend = make_backend(configuration, scene,
                                    {configuration.wavelengths, configuration.sampler, sampling.seed,
                                     sampling.replicates, configuration.rough_dispersion});
  const PixelRect rect = film_rect(*scene);
  const std::vector<double> scale = backend->film_scale();
  SpectralFilm film(rect, {scale.size(), sampling.replicates, true, true});
  Rendering result;
  const auto start = Clock::now();
  render_replicates(*backend, film, sampling.replicates, sampling.samples, watch);
  result.seconds = since(start);
  result.stopped = watch.stopped();
  result.image = image_of(film, rect, sampling.replicates, scale);
  result.invalid_samples = backend->statistics().invalid_samples;
  return result;
}

}  // namespace kiloband::validation
