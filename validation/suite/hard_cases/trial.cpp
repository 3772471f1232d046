#include "validation/suite/hard_cases/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/read/reader.hpp"
#include "shared/sampler.h"
#include "stats/distributions.hpp"
#include "validation/oracle/evaluate_reference.hpp"
#include "validation/suite/rendering.hpp"

namespace kiloband::validation {
namespace {

/// One program for all scenes.
Configuration general_kernels(const std::string& backend) {
  Configuration configuration{backend};
  configuration.specialised = false;
  return configuration;
}

SamplingSettings sampling_of(const TrialSettings& settings, uint64_t seed, uint32_t replicates) {
  return {settings.wavelengths, settings.sampler, seed, replicates};
}

void collect_pixels(const SpectralFilm& film, const std::vector<double>& scale, TrialImage& image) {
  std::vector<float> mean(std::size_t{image.width} * image.channels), variance(mean.size());
  for (uint32_t y = 0; y < image.height; ++y) {
    film.row(y, mean, variance);
    for (std::size_t i = 0; i < mean.size(); ++i) image.mean.push_back(mean[i] * scale[i % image.channels]);
  }
}

void collect_means(const SpectralFilm& film, const std::vector<double>& scale, TrialImage& image) {
  const ReplicateMoments moments = film.image_moments();
  std::vector<float> variance(image.channels);
  moments.variance_of_mean(0, variance);
  for (std::size_t c = 0; c < image.channels; ++c) {
    image.image_mean.push_back(moments.mean(0)[c] * scale[c]);
    image.image_variance.push_back(double{variance[c]} * scale[c] * scale[c]);
  }
}

/// The offset that the first sample of the first replicate of a pixel is evaluated with.
double offset_of(const SamplingSettings& s, const FlatScene& scene, uint32_t x, uint32_t y) {
  if (s.wavelengths == WavelengthMode::kShared)
    return kb_shared_mu(s.seed, 0, x / kBlockSize, y / kBlockSize, 0);
  const uint32_t sampler = s.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  return kb_path_mu(sampler, s.seed, y * scene.camera.film_width + x, 0, 0, 0);
}

/// Two-sided critical |t| of one figure among all.
double critical_t(uint32_t replicates) {
  return stats::student_upper(kHardFamilyRate / (kMostBackends * kHardStatisticalFigures) / 2,
                              replicates - 1.0);
}

}  // namespace

uint64_t Trial::by_effort(uint64_t quick, uint64_t standard, uint64_t thorough) const {
  return ByEffort<uint64_t>{quick, standard, thorough}.at(context_.effort);
}

std::shared_ptr<const FlatScene> Trial::compile_text(const std::string& xml,
                                                     const TrialSettings& settings) const {
  const SceneDescription description = read_scene_text(xml, "hard_case.xml", settings.directory);
  const ChannelList channels = parse_channels(settings.bands);
  return compile_scene(description, {channels, channels, {}});
}

TrialImage Trial::render(const std::string& xml, const TrialSettings& settings) {
  const auto compiled = compile_text(xml, settings);
  const FlatScene& scene = *compiled;
  const auto backend = make_backend(general_kernels(context_.backend), compiled,
                                    sampling_of(settings, context_.seed, settings.replicates));
  SpectralFilm film(film_rect(scene), {scene.channels.size(), settings.replicates, true});
  render_replicates(*backend, film, settings.replicates, settings.samples, context_.watch);
  TrialImage image;
  image.width = scene.film.crop_width;
  image.height = scene.film.crop_height;
  image.channels = scene.channels.size();
  image.replicates = settings.replicates;
  image.samples = settings.samples;
  for (const Channel& channel : scene.channels) image.widths_nm.push_back(channel.width_nm());
  collect_pixels(film, backend->film_scale(), image);
  collect_means(film, backend->film_scale(), image);
  const BackendStatistics done = backend->statistics();
  image.rays = done.rays;
  image.paths = done.paths;
  image.vertices = done.vertices;
  count_invalid(*backend, image);
  return image;
}

void Trial::count_invalid(const Backend& backend, const TrialImage& image) {
  const BackendStatistics done = backend.statistics();
  invalid_ += done.invalid_samples;
  samples_ += done.paths;
  not_finite_ += static_cast<uint64_t>(
      std::ranges::count_if(image.mean, [](double value) { return !std::isfinite(value); }));
}

namespace {

/// Whether an error replaces the largest one so far: NaN does, and stays.
bool is_worse(double error, double largest) {
  return !std::isnan(largest) && !(error <= largest);
}

}  // namespace

double sum_rounding(const TrialImage& image) {
  return std::min(image.samples, 64u) * 0x1p-24;
}

void Trial::exact(const std::string& name, const TrialImage& image, std::size_t channel, double reference,
                  double rounding, const std::string& reason) {
  const double expected = reference * image.widths_nm[channel];
  const double limit = rounding + sum_rounding(image);
  double worst = expected, error = 0;
  for (std::size_t i = channel; i < image.mean.size(); i += image.channels) {
    const double relative = std::abs(image.mean[i] / expected - 1);
    if (is_worse(relative, error)) error = relative, worst = image.mean[i];
  }
  figures_.push_back({name, "W m^-2 sr^-1 nm^-1", worst / image.widths_nm[channel], reference, error, limit,
                      error <= limit, false, "relative, worst pixel; " + reason});
}

void Trial::statistical(const std::string& name, const TrialImage& image, std::size_t channel,
                        double reference, double rounding) {
  const double width = image.widths_nm[channel];
  const double value = image.image_mean[channel] / width;
  const double standard_error = std::sqrt(image.image_variance[channel]) / width;
  const double limit = critical_t(image.replicates) * standard_error + rounding * reference;
  const double error = std::abs(value - reference);
  figures_.push_back(
      {name, "W m^-2 sr^-1 nm^-1", value, reference, error, limit, error <= limit, true,
       fmt::format("standard error {:.2g} of the value, t = {:.2f}", standard_error / reference,
                   standard_error > 0 ? (value - reference) / standard_error : 0.0)});
}

void Trial::figure(const std::string& name, const std::string& unit, double value, double reference,
                   double limit, const std::string& note) {
  const double error = std::abs(value - reference);
  figures_.push_back({name, unit, value, reference, error, limit, error <= limit, false, note});
}

namespace {

/// The paths that a backend follows. The method pt evaluates its paths on the way and keeps no vertex; the
/// other methods follow the same ones.
std::vector<TracedPath> trace_paths(const std::string& backend, const std::shared_ptr<const FlatScene>& scene,
                                    const SamplingSettings& sampling) {
  const std::string keeper = backend == "opencl:pt" ? "opencl:dpept-batch" : backend;
  return make_backend(general_kernels(keeper), scene, sampling)->trace(film_rect(*scene), {0, 0, 1});
}

/// What the oracle sees along a path, per channel; a path without records brings nothing.
std::vector<double> evaluated(const FlatScene& scene, const TracedPath& path, double mu) {
  if (path.entries.empty()) return std::vector<double>(scene.channels.size(), 0.0);
  const cpu::PathBuffer buffer{path.entries, {{0, static_cast<uint32_t>(path.entries.size()), 0}}};
  return evaluate_path_reference(scene, {}, buffer, 0, mu);
}

}  // namespace

void Trial::at_least(const std::string& name, const std::string& unit, double value, double least,
                     const std::string& note) {
  figures_.push_back(
      {name, unit, value, least, std::max(least - value, 0.0), 0, value >= least, false, note});
}

/// Operations round by 6e-8 each; a vertex has about 20 in other order than the oracle's, and the rounding of
/// a reflectance to float is the same at each vertex of a path:
/// 1e-5 + 6e-8 per vertex (as tests/unit/src_cpu/evaluate).
void Trial::oracle(const std::string& name, const std::string& xml, const TrialSettings& settings) {
  const auto compiled = compile_text(xml, settings);
  const FlatScene& scene = *compiled;
  const SamplingSettings sampling = sampling_of(settings, context_.seed, 1);
  const auto backend = make_backend(general_kernels(context_.backend), compiled, sampling);
  const PixelRect rect = film_rect(scene);
  SpectralFilm film(rect, {scene.channels.size(), 1, true});
  render_replicates(*backend, film, 1, 1, context_.watch);
  TrialImage image{rect.width, rect.height, scene.channels.size()};
  collect_pixels(film, backend->film_scale(), image);
  count_invalid(*backend, image);
  const std::vector<TracedPath> paths = trace_paths(context_.backend, compiled, sampling);
  double error = 0, value = 0, reference = 0;
  std::size_t slots = 0;
  for (uint32_t p = 0; p < paths.size(); ++p) {
    slots = std::max(slots, paths[p].entries.size());
    const double mu = offset_of(sampling, scene, p % rect.width, p / rect.width);
    const std::vector<double> expected = evaluated(scene, paths[p], mu);
    const double largest = *std::ranges::max_element(expected);
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const double seen = image.mean[p * image.channels + k], difference = std::abs(seen - expected[k]);
      const double relative = difference == 0 ? 0 : difference / largest;  // infinite where black is expected
      if (is_worse(relative, error)) error = relative, value = seen, reference = expected[k];
    }
  }
  const double limit = 1e-5 + 6e-8 * static_cast<double>(slots);
  figures_.push_back({name, "W m^-2 sr^-1", value, reference, error, limit, error <= limit && slots > 0,
                      false,
                      fmt::format("relative, against the double oracle; paths of up to {} records", slots)});
}

std::vector<HardFigure> Trial::finish() {
  figure("samples that are not finite", "samples", static_cast<double>(invalid_ + not_finite_), 0, 0,
         fmt::format("of {}", samples_));
  return std::move(figures_);
}

std::string short_text(double x) {
  return fmt::format("{:g}", x);
}

double planck_per_nm(double lambda_nm, double temperature_k) {
  constexpr double kH = 6.62607015e-34, kC = 299792458.0, kK = 1.380649e-23;
  const double metres = lambda_nm * 1e-9;
  return 2 * kH * kC * kC / std::pow(metres, 5) / std::expm1(kH * kC / (metres * kK * temperature_k)) * 1e-9;
}

}  // namespace kiloband::validation
