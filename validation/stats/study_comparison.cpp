// Simulated false-alarm rates and power of the comparison core. Prints tables in Markdown.
// Usage: study_comparison [trials] [rates|truth|means|variances|channels]...
// (200 trials and all parts without arguments)
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "stats/comparison/comparison.hpp"
#include "stats/distributions.hpp"
#include "stats/max_t.hpp"
#include "tests/support/simulated_image.hpp"

namespace {

using namespace kiloband;
using namespace kiloband::stats;
using test::BatchPool;
using test::SimulatedImage;

/// The p-values of all tests over many comparisons.
struct Rates {
  int trials = 0;
  std::map<std::string, std::vector<double>> p;
  std::vector<double> smallest;  // of a comparison, times its number of tests

  void add(const Comparison& c) {
    ++trials;
    double least = 1;
    for (const TestVerdict& test : c.tests) {
      p[test.name].push_back(test.p);
      least = std::min(least, test.p);
    }
    smallest.push_back(least * static_cast<double>(c.tests.size()));
  }
  static double share(const std::vector<double>& values, double limit) {
    double count = 0;
    for (const double value : values) count += value < limit;
    return count / static_cast<double>(values.size());
  }
};

const std::vector<std::string> kNames{"mean/pixel",    "mean/tile",     "mean/image",     "variance/pixel",
                                      "variance/tile", "scatter/image", "variance/image", "uniform/pixel"};

void print_head(const char* first) {
  std::printf("\n| %s |", first);
  for (const std::string& name : kNames) std::printf(" %s |", name.c_str());
  std::printf(" comparison |\n|---|");
  for (std::size_t i = 0; i <= kNames.size(); ++i) std::printf("---|");
  std::printf("\n");
}

/// level: of a test; comparisons fail at `alpha`.
void print_rates(const std::string& what, const Rates& rates, double level, double alpha) {
  std::printf("| %s |", what.c_str());
  for (const std::string& name : kNames) {
    const auto found = rates.p.find(name);
    if (found == rates.p.end())
      std::printf(" - |");
    else
      std::printf(" %.3f |", Rates::share(found->second, level));
  }
  std::printf(" %.3f |\n", Rates::share(rates.smallest, alpha));
  std::fflush(stdout);
}

struct Change {
  std::string name;
  std::function<double(uint32_t, uint32_t, std::size_t)> mean, spread;
};

Rates run(int trials, const BatchPool& pool, SimulatedImage image, const Change& change, double alpha) {
  Rates rates;
  for (int i = 0; i < trials; ++i) {
    const auto seed = static_cast<uint64_t>(i);
    SimulatedImage other = image;
    other.mean = change.mean;
    other.spread = change.spread;
    ComparisonOptions options{.alpha = alpha, .seed = seed};
    rates.add(
        compare_independent(simulate(image, pool, 2 * seed), simulate(other, pool, 2 * seed + 1), options));
  }
  return rates;
}

const SimulatedImage kSmall{32, 32};

void study_rates(int trials) {
  std::printf(
      "\nFalse alarms: share of %d comparisons with p < 5 %% (first line) and p < 1 %% (second); whole "
      "comparison at "
      "alpha = 5 %% and 1 %%. 32x32 pixels, 4 channels, 32 replicates; with 8 samples 0.1 of a value is "
      "common to "
      "the whole image.\n",
      trials);
  print_head("distribution, samples per replicate");
  for (const char* distribution : {"normal", "exponential", "rare", "lognormal", "firefly", "pareto"}) {
    for (const uint32_t samples : {1u, 8u, 64u}) {
      const BatchPool pool(distribution, samples);
      const std::string what = std::string(distribution) + ", " + std::to_string(samples);
      SimulatedImage image = kSmall;
      image.block_common = samples == 8 ? 0.1 : 0;
      image.common = 0.7 - image.block_common;
      const Rates rates = run(trials, pool, image, {}, 0.01);
      print_rates(what, rates, 0.05, 0.05);
      print_rates("", rates, 0.01, 0.01);
    }
  }
}

void study_truth(int trials) {
  std::printf("\nKnown truth: the same, p < 1 %%, alpha = 1 %%.\n");
  print_head("distribution, samples per replicate");
  for (const char* distribution : {"normal", "exponential", "rare", "lognormal", "firefly"}) {
    for (const uint32_t samples : {8u, 64u}) {
      const BatchPool pool(distribution, samples);
      Rates rates;
      for (int i = 0; i < trials; ++i) {
        const auto image = simulate(kSmall, pool, static_cast<uint64_t>(i));
        rates.add(compare_truth(image, {{1, 1.5, 2, 2.5}, {}, false}, {.alpha = 0.01}));
      }
      print_rates(std::string(distribution) + ", " + std::to_string(samples), rates, 0.01, 0.01);
    }
  }
}

void study_means(int trials) {
  std::printf("\nPower: share of %d comparisons in which a test is below its share of alpha = 1e-4.\n",
              trials);
  const auto factor = [](double f, int every) {
    return [=](uint32_t x, uint32_t y, std::size_t) {
      return (y * 64 + x) * 2654435761u % static_cast<unsigned>(every) == 0 ? f : 1.0;
    };
  };
  const std::vector<Change> changes{{"+0.2 % everywhere", factor(1.002, 1), {}},
                                    {"+1 % everywhere", factor(1.01, 1), {}},
                                    {"+10 % of 1 % of the pixels", factor(1.1, 100), {}},
                                    {"+50 % of 0.2 % of the pixels", factor(1.5, 500), {}},
                                    {"none", {}, {}}};
  for (const char* distribution : {"exponential", "lognormal", "firefly"}) {
    for (const uint32_t samples : {8u, 64u}) {
      const BatchPool pool(distribution, samples);
      std::printf("\n%s, %u samples per pixel:\n", distribution, samples * 32);
      print_head("bias");
      for (const Change& change : changes)
        print_rates(change.name, run(trials, pool, {}, change, 1e-4), 1e-4 / 8, 1e-4);
    }
  }
}

void study_variances(int trials) {
  std::printf(
      "\nPower for variances: share of %d comparisons, alpha = 1e-4, 8 samples per replicate, 64x64 "
      "pixels.\n",
      trials);
  print_head("distribution, ratio");
  for (const char* distribution : {"normal", "exponential", "lognormal", "firefly", "pareto"}) {
    const BatchPool pool(distribution, 8);
    for (const double ratio : {1.02, 1.05, 1.1, 1.5}) {
      const Change change{"", {}, [=](uint32_t, uint32_t, std::size_t) { return std::sqrt(ratio); }};
      print_rates(std::string(distribution) + ", " + std::to_string(ratio).substr(0, 4),
                  run(trials, pool, {}, change, 1e-4), 1e-4 / 8, 1e-4);
    }
  }
}

/// max |t| over K dependent channels of one unit: rotations against Bonferroni and label permutations.
void study_channels(int trials) {
  std::printf(
      "\nmax |t| over 40 channels of one unit, %d pairs without difference: share with p < 5 %% and < 1 "
      "%%.\n\n",
      10 * trials);
  std::printf(
      "| distribution, common part | rotations | Bonferroni | 999 permutations | rotations < 1 %% | "
      "Bonferroni "
      "< 1 %% | permutations < 1 %% |\n|---|---|---|---|---|---|---|\n");
  for (const char* distribution : {"normal", "exponential", "lognormal"}) {
    const BatchPool pool(distribution, 8);
    for (const double common : {0.0, 0.5, 0.8}) {
      double counts[2][3] = {};
      for (int i = 0; i < 10 * trials; ++i) {
        const auto seed = static_cast<uint64_t>(i);
        const SimulatedImage shape{1, 1, 32, 40, common};
        UnitSample a, b;
        gather_pixel(simulate(shape, pool, 2 * seed), 0, a);
        gather_pixel(simulate(shape, pool, 2 * seed + 1), 0, b);
        const Contrast contrast = independent_contrast(a, b, 0);
        const Strongest strongest = strongest_channel(contrast, {});
        const double p[] = {max_t_p(contrast, {}, strongest, seed), std::min(1.0, 40 * strongest.p),
                            label_permutation_p(a, b, 999, seed)};
        for (int k = 0; k < 3; ++k) {
          counts[0][k] += p[k] < 0.05;
          counts[1][k] += p[k] < 0.01;
        }
      }
      std::printf("| %s, %.1f |", distribution, common);
      for (const auto& row : counts) {
        for (const double count : row) std::printf(" %.4f |", count / (10 * trials));
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int trials = argc > 1 ? std::atoi(argv[1]) : 200;
  const std::set<std::string> parts(argv + std::min(argc, 2), argv + argc);
  const auto wanted = [&](const char* part) { return parts.empty() || parts.contains(part); };
  if (wanted("rates")) study_rates(trials);
  if (wanted("truth")) study_truth(trials);
  if (wanted("means")) study_means(std::max(1, trials / 5));
  if (wanted("variances")) study_variances(std::max(1, trials / 5));
  if (wanted("channels")) study_channels(trials);
}
