// One hard case being run: renders scenes on the context's backend and collects figures.
#pragma once

#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "validation/suite/hard_cases/hard_cases.hpp"

namespace kiloband::validation {

inline constexpr double kPi = std::numbers::pi;
inline constexpr int kNoRoulette = 1000000;  // rr_depth beyond all paths

struct TrialSettings {
  std::string bands = "10000-10000.001";
  uint32_t samples = 4;  // per pixel and replicate
  uint32_t replicates = 2;
  WavelengthMode wavelengths = WavelengthMode::kShared;
  SamplerType sampler = SamplerType::kSobol;
  std::filesystem::path directory = ".";
};

/// Values are in W m^-2 sr^-1, integrals over the channel.
struct TrialImage {
  uint32_t width = 0, height = 0;
  std::size_t channels = 0;
  uint32_t replicates = 0;
  std::vector<double> widths_nm;                   // [channel]
  std::vector<double> mean;                        // [pixel][channel]
  std::vector<double> image_mean, image_variance;  // [channel]; variance of the mean
  uint32_t samples = 0;                            // per pixel and replicate
  uint64_t rays = 0, paths = 0, vertices = 0;

  double at(uint32_t x, uint32_t y, std::size_t channel) const {
    return mean[(std::size_t{y} * width + x) * channels + channel];
  }
};

/// Relative error of the film's sums: at most 64 float additions each, before they are joined in double.
double sum_rounding(const TrialImage& image);

class Trial {
 public:
  explicit Trial(const HardCaseContext& context) : context_(context) {}

  Effort effort() const { return context_.effort; }
  /// The one of three that the effort chooses.
  uint64_t by_effort(uint64_t quick, uint64_t standard, uint64_t thorough) const;

  /// throws what reading, flattening and rendering throw. Invalid samples and values that are not finite are
  /// counted.
  TrialImage render(const std::string& xml, const TrialSettings& settings);

  /// The largest relative error of the pixels of a channel against `reference` > 0, which is per nm of the
  /// channel. To the limit comes what the sum of a replicate's samples may be off, of which at most 64 are
  /// added in float: min(samples, 64) * 2^-24.
  void exact(const std::string& name, const TrialImage& image, std::size_t channel, double reference,
             double rounding, const std::string& reason);
  /// The image mean of a channel, in W m^-2 sr^-1 nm^-1, by a t-test. rounding: relative, added to the limit.
  void statistical(const std::string& name, const TrialImage& image, std::size_t channel, double reference,
                   double rounding);
  /// |value - reference| <= limit
  void figure(const std::string& name, const std::string& unit, double value, double reference, double limit,
              const std::string& note);
  /// value >= least
  void at_least(const std::string& name, const std::string& unit, double value, double least,
                const std::string& note);
  /// One sample of every pixel: the film against the double-precision oracle on the backend's own paths.
  /// Largest error relative to the pixel's largest channel; black where the oracle says so.
  void oracle(const std::string& name, const std::string& xml, const TrialSettings& settings);

  /// What was collected, and the count of invalid and non-finite values over all renders, which must be 0.
  std::vector<HardFigure> finish();

 private:
  std::shared_ptr<const FlatScene> compile_text(const std::string& xml, const TrialSettings& settings) const;
  void count_invalid(const Backend& backend, const TrialImage& image);

  const HardCaseContext& context_;
  std::vector<HardFigure> figures_;
  uint64_t invalid_ = 0, not_finite_ = 0, samples_ = 0;
};

/// For names: six digits.
std::string short_text(double x);

/// Planck's law in double, W m^-2 sr^-1 nm^-1, written down here once more.
double planck_per_nm(double lambda_nm, double temperature_k);

}  // namespace kiloband::validation
