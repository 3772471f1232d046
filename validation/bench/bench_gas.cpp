// Error of a channel's transmission and emission against line-by-line quadrature, over the number of wavelength
// offsets, for sampled lines and for correlated k.
//
//   bench_gas FILE... [--length 1] [--temperature 300]
//
// A slab of the gas in front of black; per channel the mean over N shared offsets (kb_shared_mu, replicate 0) of
// exp(-kappa d) and of (1 - exp(-kappa d)) B(T). Printed: root mean square over 64 seeds and all channels of the error,
// relative to the channel's exact value (transmission: to 1). FILE: an absorption coefficient; without one a comb of Lorentz
// lines of half width 0.05 nm, 1 nm apart, 2 /m high.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <vector>

#include "shared/sampler.h"
#include "spectral/channel_knots.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "spectral/planck.hpp"

namespace kiloband {
namespace {

constexpr uint64_t kSeeds = 64;

struct Gas {
  std::string name;
  Spectrum absorption;
  double min_nm, max_nm;
};

Gas comb() {
  std::vector<double> lambda_nm, kappa;
  for (double x = 4500; x <= 4600; x += 0.005) {
    double sum = 0;
    for (double line = 4500.5; line < 4600; ++line) sum += 2 / (1 + std::pow((x - line) / 0.05, 2));
    lambda_nm.push_back(x);
    kappa.push_back(sum);
  }
  return {"comb", Spectrum::tabulated(lambda_nm, kappa, true), 4500, 4600};
}

Gas from_file(const std::string& file) {
  const Spectrum absorption = read_spectrum_file(file, ValueKind::kAbsorption);
  const auto range = *absorption.data_range();
  return {std::filesystem::path(file).filename().string(), absorption, range.min_nm, range.max_nm};
}

struct Slab {
  double metres, temperature_k;
  double transmission(double kappa) const { return std::exp(-kappa * metres); }
  double emission(double kappa, double lambda_nm) const {
    return -std::expm1(-kappa * metres) * planck_radiance(lambda_nm, temperature_k);
  }
};

struct Values {
  double transmission = 0, emission = 0;
};

/// Simpson's rule on four parts of every piece of the data.
Values exact(const ChannelKnots& knots, std::size_t k, const Channel& c, const Slab& slab) {
  constexpr int kParts = 4;
  Values sum;
  for (uint32_t i = knots.first[k]; i + 1 < knots.first[k + 1]; ++i) {
    const double width = knots.mu[i + 1] - knots.mu[i];
    for (int j = 0; j <= kParts; ++j) {
      const double t = static_cast<double>(j) / kParts, mu = knots.mu[i] + t * width;
      const double weight = width / kParts / 3 * (j == 0 || j == kParts ? 1 : j % 2 ? 4 : 2);
      const double kappa = (1 - t) * knots.value[i] + t * knots.value[i + 1];
      sum.transmission += weight * slab.transmission(kappa);
      sum.emission += weight * slab.emission(kappa, c.min_nm + mu * c.width_nm());
    }
  }
  return sum;
}

Values estimate(const ChannelKnots& knots, std::size_t k, const Channel& c, const Slab& slab, uint64_t seed,
                uint32_t samples) {
  Values mean;
  for (uint32_t i = 0; i < samples; ++i) {
    const double mu = kb_shared_mu(seed, 0, 0, 0, i);
    const double kappa = knots(k, mu);
    mean.transmission += slab.transmission(kappa) / samples;
    mean.emission += slab.emission(kappa, c.min_nm + mu * c.width_nm()) / samples;
  }
  return mean;
}

/// RMS errors over seeds and channels.
Values errors(const ChannelKnots& knots, const std::vector<Values>& truth, const ChannelList& channels,
              const Slab& slab, uint32_t samples) {
  Values sum;
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      const Values v = estimate(knots, k, channels[k], slab, seed, samples);
      sum.transmission += std::pow(v.transmission - truth[k].transmission, 2);
      sum.emission += std::pow(v.emission / truth[k].emission - 1, 2);
    }
  const double n = static_cast<double>(kSeeds * channels.size());
  return {std::sqrt(sum.transmission / n), std::sqrt(sum.emission / n)};
}

void measure(const Gas& gas, double width_nm, const Slab& slab) {
  ChannelList channels;
  const double span = gas.max_nm - gas.min_nm;
  for (int i = 0; i < 8; ++i) {
    const double first = gas.min_nm + (0.1 + 0.8 * i / 8) * span;
    channels.push_back({first, std::min(first + width_nm, gas.max_nm), {}});
  }
  const ChannelKnots sampled = sampled_knots(gas.absorption, channels, gas.name);
  const ChannelKnots sorted = sorted_knots(sampled);
  std::vector<Values> truth;
  for (std::size_t k = 0; k < channels.size(); ++k) truth.push_back(exact(sampled, k, channels[k], slab));
  fmt::print("{} channels of {:g} nm, {:g} m at {:g} K: {} knots, sorted {}\n", gas.name, width_nm,
             slab.metres, slab.temperature_k, sampled.mu.size(), sorted.mu.size());
  for (const uint32_t samples : {1u, 4u, 16u, 64u, 256u, 1024u, 4096u}) {
    const Values a = errors(sampled, truth, channels, slab, samples),
                 b = errors(sorted, truth, channels, slab, samples);
    fmt::print("  N {:<5} sampled {:.2e} {:.2e}   correlated_k {:.2e} {:.2e}\n", samples, a.transmission,
               a.emission, b.transmission, b.emission);
  }
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  using namespace kiloband;
  std::vector<std::string> files;
  Slab slab{1, 300};
  CLI::App program("Error of gas lines against line-by-line quadrature");
  program.add_option("files", files, "absorption coefficients");
  program.add_option("--length", slab.metres, "m")->capture_default_str();
  program.add_option("--temperature", slab.temperature_k, "K")->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  std::vector<Gas> gases;
  for (const std::string& file : files) gases.push_back(from_file(file));
  if (gases.empty()) gases.push_back(comb());
  for (const Gas& gas : gases)
    for (const double width_nm : {0.01, 0.1, 1.0, 10.0}) measure(gas, width_nm, slab);
  return 0;
}
