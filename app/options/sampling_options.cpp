#include "app/options/sampling_options.hpp"

#include "app/options/whole_numbers.hpp"

namespace kiloband {

void SamplingOptions::add_to(CLI::App& command) {
  command.add_option("--wavelengths", wavelengths, "wavelength sampling")
      ->check(CLI::IsMember({"shared", "per-path"}))
      ->capture_default_str();
  command.add_option("--sampler", sampler, "random numbers")
      ->check(CLI::IsMember({"sobol", "independent"}))
      ->capture_default_str();
  command
      .add_option(
          "--rough-dispersion", rough_dispersion,
          "rough boundaries of dispersive materials: all channels by spectral MIS, or one by degradation")
      ->check(CLI::IsMember({"mis", "degrade"}))
      ->capture_default_str();
  command.add_option("--seed", seed, "seed of all random numbers")
      ->transform(any_whole_number())
      ->capture_default_str();
}

SamplingSettings SamplingOptions::settings(uint32_t replicates) const {
  SamplingSettings sampling;
  sampling.seed = seed;
  sampling.replicates = replicates;
  sampling.wavelengths = wavelengths == "shared" ? WavelengthMode::kShared : WavelengthMode::kPerPath;
  sampling.sampler = sampler == "sobol" ? SamplerType::kSobol : SamplerType::kIndependent;
  sampling.rough_dispersion =
      rough_dispersion == "mis" ? RoughDispersion::kSpectralMis : RoughDispersion::kDegrade;
  return sampling;
}

}  // namespace kiloband
