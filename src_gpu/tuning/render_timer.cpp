#include "src_gpu/tuning/render_timer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.hpp"
#include "src_gpu/device/memory.hpp"
#include "src_gpu/device_state.hpp"

namespace kiloband::opencl {
namespace {

/// A round's, on a GPU.
constexpr uint32_t kFewestSamples = 16, kMostSamples = 1u << 20;
constexpr uint32_t kWarmPart = 4;

}  // namespace

RenderTimer::RenderTimer(std::shared_ptr<const FlatScene> scene, const SamplingSettings& sampling,
                         const Options& options)
    : scene_(std::move(scene)),
      sampling_(sampling),
      options_(options),
      device_(select_device(options.device)),
      maker_(backend_maker(scene_, {}, sampling, device_)) {
  options_.tuned = false;
}

std::unique_ptr<Backend> RenderTimer::make(const Tuning& tuning) const {
  Options options = options_;
  options.tuning = tuning;
  return maker_(options);
}

double RenderTimer::render(Backend& backend, uint32_t samples, const std::atomic<bool>& stop) const {
  SpectralFilm film(film_rect(*scene_), {.channels = backend.film_scale().size(), .sums = {}});
  const std::vector<uint32_t> blocks = film.all_blocks();
  const auto start = std::chrono::steady_clock::now();
  backend.render(film, {0, 0, samples}, blocks, stop, {});
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void RenderTimer::calibrate(double seconds, const std::atomic<bool>& stop) {
  const auto backend = make({});
  samples_ = kFewestSamples;
  render(*backend, 1, stop);  // compiles what is compiled late
  while (!stop && samples_ < kMostSamples) {
    const double taken = render(*backend, samples_, stop);
    if (taken >= seconds) return;
    const double factor = std::clamp(seconds / std::max(taken, 1e-6), 1.2, 8.0);
    samples_ = static_cast<uint32_t>(std::min(std::ceil(samples_ * factor), double{kMostSamples}));
  }
}

std::optional<double> RenderTimer::time(const Tuning& tuning, const std::atomic<bool>& stop) const {
  try {
    const auto backend = make(tuning);
    render(*backend, std::max(samples_ / kWarmPart, 1u), stop);
    const double seconds = render(*backend, samples_, stop);
    return stop ? std::nullopt : std::optional(seconds);
  } catch (const DeviceError&) {
    return std::nullopt;
  }
}

uint64_t RenderTimer::paths() const {
  return uint64_t{scene_->film.crop_width} * scene_->film.crop_height * samples_;
}

TuningBounds RenderTimer::bounds() const {
  const EvaluationTask task =
      evaluation_task(*scene_, options_.method.value_or(kDefaultMethod),
                      sampling_.wavelengths == WavelengthMode::kShared, options_.specialised);
  const TunedRender render{task, paths()};
  return tuning_bounds(device_, render, options_.device_memory.value_or(default_memory_budget(device_)));
}

}  // namespace kiloband::opencl
