#include "validation/suite/convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stats/distributions.hpp"
#include "validation/suite/error_rates.hpp"

namespace kiloband::validation {
namespace {

constexpr uint32_t kReplicates = 16, kFirstSamples = 2, kStep = 2;

/// Sum over pixels and channels of the variance between the replicates, each channel relative to its mean;
/// `left_out` is not counted (kReplicates: all are).
double relative_variance(const stats::ReplicateImage& image, const std::vector<double>& means,
                         uint32_t left_out) {
  double sum = 0;
  const double count = left_out < image.replicates ? image.replicates - 1.0 : image.replicates;
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (std::size_t c = 0; c < image.channels; ++c) {
      if (means[c] == 0) continue;
      double total = 0, squares = 0;
      for (uint32_t r = 0; r < image.replicates; ++r) {
        if (r == left_out) continue;
        const double value = image.at(r, pixel, c) / means[c];
        total += value;
        squares += value * value;
      }
      sum += (squares - total * total / count) / (count - 1);
    }
  }
  const double variance = sum / static_cast<double>(image.pixels() * image.channels);
  return variance < 0 ? 0 : variance;  // rounding; NaN stays
}

std::vector<double> channel_means(const stats::ReplicateImage& image) {
  std::vector<double> means(image.channels, 0.0);
  for (std::size_t i = 0; i < image.means.size(); ++i) means[i % image.channels] += image.means[i];
  for (double& mean : means) mean /= static_cast<double>(image.pixels()) * image.replicates;
  return means;
}

/// Least squares of ln sqrt(variance) over ln samples.
double slope_of(const std::vector<uint32_t>& samples, const std::vector<double>& variances) {
  const auto n = static_cast<double>(samples.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double u = std::log(samples[i]), v = 0.5 * std::log(variances[i]);
    x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

/// A point's variance, and without each of its replicates in turn.
struct Scatter {
  double all = 0;
  std::vector<double> without;
};

Scatter scatter_of(const stats::ReplicateImage& image) {
  const std::vector<double> means = channel_means(image);
  Scatter scatter{relative_variance(image, means, image.replicates), {}};
  for (uint32_t r = 0; r < image.replicates; ++r)
    scatter.without.push_back(relative_variance(image, means, r));
  return scatter;
}

/// Points have independent seeds, so the slope's variance is the sum over points of what each one's jackknife
/// gives (degrees of freedom: Satterthwaite's).
void fit(ConvergenceCurve& curve, const std::vector<Scatter>& scatters) {
  std::vector<uint32_t> samples;
  std::vector<double> variances;
  for (std::size_t i = 0; i < scatters.size(); ++i) {
    samples.push_back(curve.points[i].samples);
    variances.push_back(scatters[i].all);
  }
  curve.slope = slope_of(samples, variances);
  double variance = 0, squared_variances = 0;
  for (std::size_t i = 0; i < scatters.size(); ++i) {
    const std::vector<double> all = variances;
    std::vector<double> slopes;
    for (const double without : scatters[i].without) {
      variances[i] = without;
      slopes.push_back(slope_of(samples, variances));
    }
    variances = all;
    const auto n = static_cast<double>(slopes.size());
    double mean = 0, squares = 0;
    for (const double s : slopes) mean += s / n;
    for (const double s : slopes) squares += (s - mean) * (s - mean);
    const double of_point = (n - 1) / n * squares;
    variance += of_point;
    squared_variances += of_point * of_point / (n - 1);
  }
  curve.slope_error = std::sqrt(variance);
  curve.slope_dof = squared_variances > 0 ? variance * variance / squared_variances : 0;
}

ConvergenceCurve measure(const std::shared_ptr<const FlatScene>& scene, const Configuration& configuration,
                         uint32_t most, uint64_t seed, const Watch& watch) {
  ConvergenceCurve curve{configuration, {}, 0, 0, 0, 0};
  std::vector<Scatter> scatters;
  // Once without a clock: the first render compiles kernels, or reads them from the disk.
  render(scene, configuration, {seed, kReplicates, kFirstSamples}, watch);
  for (uint32_t samples = kFirstSamples; samples <= most && !watch.stopped(); samples *= kStep) {
    const Rendering rendering = render(scene, configuration, {seed + samples, kReplicates, samples}, watch);
    if (rendering.stopped) break;
    curve.invalid_samples += rendering.invalid_samples;
    scatters.push_back(scatter_of(rendering.image));
    curve.points.push_back({samples, std::sqrt(scatters.back().all), rendering.seconds / kReplicates});
  }
  if (scatters.size() >= 2) fit(curve, scatters);
  return curve;
}

std::vector<Configuration> configurations(const std::vector<std::string>& backends, Effort effort) {
  std::vector<Configuration> all;
  for (const std::string& backend : backends) {
    all.push_back({backend});
    if (effort == Effort::kQuick && backend != backends.front()) continue;
    all.push_back({backend, WavelengthMode::kShared, SamplerType::kIndependent});
    all.push_back({backend, WavelengthMode::kPerPath, SamplerType::kSobol});
    all.push_back({backend, WavelengthMode::kPerPath, SamplerType::kIndependent});
  }
  for (Configuration& configuration : all) configuration.specialised = effort != Effort::kQuick;
  return all;
}

/// Independent samples: then the slope is -1/2.
bool has_known_slope(const Configuration& configuration) {
  return configuration.sampler == SamplerType::kIndependent;
}

/// What is wrong with a curve; empty: nothing. level: of its slope where that is known, two-sided
std::string failure_of(const ConvergenceCurve& curve, double level) {
  if (curve.invalid_samples > 0) return fmt::format("{} invalid samples", curve.invalid_samples);
  if (!(curve.slope_dof > 0) || !std::isfinite(curve.slope))
    return "no slope: an image without noise, or with values that are not finite";
  if (!has_known_slope(curve.configuration)) return {};
  const double critical_t = stats::student_upper(level / 2, curve.slope_dof);
  if (std::abs(curve.slope + 0.5) <= critical_t * curve.slope_error) return {};
  return fmt::format("slope {:.4f} +- {:.4f} instead of -1/2", curve.slope, curve.slope_error);
}

void judge(ConvergenceResult& result, double level) {
  const ConvergenceCurve& curve = result.curves.back();
  const std::string failure = failure_of(curve, level);
  if (failure.empty()) return;
  result.passed = false;
  result.note += fmt::format("{}: {}; ", curve.configuration.label(), failure);
}

}  // namespace

std::vector<ConvergenceCase> convergence_cases(const SceneFolders& folders) {
  return {{"convergence/cornell_box",
           {folders.scenes / "cornell_box/cornell_box.xml", {}, "400:700:64", 32, 32},
           {8, 128, 1024}},
          {"convergence/flint_ball",
           {folders.validation / "flint_ball.xml", {}, "400:700:32", 24, 24},
           {8, 128, 1024}},
          {"convergence/metals_and_lamps",
           {folders.validation / "metals_and_lamps.xml", {}, "400:700:32", 32, 32},
           {8, 128, 1024}}};
}

ConvergenceResult run_convergence(const ConvergenceCase& c, const ConvergenceSettings& settings,
                                  const Watch& watch) {
  ConvergenceResult result{c.name, {}, true, false, {}};
  try {
    const auto scene = load(c.scene);
    const std::vector<Configuration> all = configurations(settings.backends, settings.effort);
    const auto known = static_cast<std::size_t>(std::ranges::count_if(all, has_known_slope));
    const double level = kConvergenceRate / static_cast<double>(settings.cases * known);
    for (const Configuration& configuration : all) {
      ConvergenceCurve curve =
          measure(scene, configuration, c.most_samples.at(settings.effort), settings.seed, watch);
      result.interrupted = watch.stopped();
      if (result.interrupted) break;
      result.curves.push_back(std::move(curve));
      judge(result, level);
    }
  } catch (const std::exception& error) {
    result.passed = false;
    result.note += error.what();
  }
  return result;
}

}  // namespace kiloband::validation
