// How often the suite raises a false alarm: the same comparisons for many seeds, with nothing wrong.
//
//   null_rates [SEEDS] [CASE] [FILE]     (200, cornell_box)
//
// Prints, per comparison, in how many of the seeds it fails at 5 % and at 1 %, with the 99 % limits of the
// binomial law, and for each of its tests how uniform the p-values are (Kolmogorov-Smirnov). FILE gets all
// p-values, a line per comparison and test.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "src_gpu/device/device.hpp"
#include "stats/distributions.hpp"
#include "validation/suite/run_case.hpp"

namespace {

using namespace kiloband;
using namespace kiloband::validation;

/// The p-value of a comparison: it fails at level alpha if any test's p is below its share of alpha.
double p_of(const stats::Comparison& c) {
  double p = 1;
  for (const stats::TestVerdict& v : c.tests) {
    if (v.level > 0) p = std::min(p, v.p * c.alpha / v.level);
  }
  return p;
}

/// Kolmogorov's limit law for sqrt(n) D; good to 1 % from n = 35 on.
double uniformity_p(std::vector<double> p) {
  std::ranges::sort(p);
  const auto n = static_cast<double>(p.size());
  double distance = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto below = static_cast<double>(i);
    distance = std::max({distance, p[i] - below / n, (below + 1) / n - p[i]});
  }
  return stats::kolmogorov_p((std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * distance);
}

struct Series {
  std::vector<double> p;
  std::map<std::string, std::vector<double>> tests;
};

std::size_t below(const std::vector<double>& p, double level) {
  return static_cast<std::size_t>(std::ranges::count_if(p, [=](double x) { return x < level; }));
}

/// The largest count that chance alone exceeds with probability 1 %.
double binomial_limit(std::size_t n, double rate) {
  return boost::math::quantile(boost::math::binomial(static_cast<double>(n), rate), 0.99);
}

void print(const std::string& name, const Series& s) {
  const std::size_t n = s.p.size();
  fmt::print("{}\n  fails at 5 %: {} of {} (99 % limit {:.0f}), at 1 %: {} (limit {:.0f}); median p {:.2f}\n",
             name, below(s.p, 0.05), n, binomial_limit(n, 0.05), below(s.p, 0.01), binomial_limit(n, 0.01),
             [&] {
               std::vector<double> sorted = s.p;
               std::ranges::sort(sorted);
               return sorted[n / 2];
             }());
  for (const auto& [test, p] : s.tests)
    fmt::print("    {:<15} p < 5 %: {:>3}, < 1 %: {:>3}, uniform: p {:.3f}\n", test, below(p, 0.05),
               below(p, 0.01), uniformity_p(p));
}

/// "sides; test; p; p; ..."
void write(const std::string& file, const std::map<std::string, Series>& series) {
  std::ofstream out(file);
  for (const auto& [name, s] : series) {
    for (const auto& [test, p] : s.tests)
      out << fmt::format("{}; {}; {:.4g}\n", name, test, fmt::join(p, "; "));
  }
  if (!out) throw InputError(file + ": cannot be written");
}

int run(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 200;
  const std::string wanted = argc > 2 ? argv[2] : "cornell_box";
  const std::filesystem::path root = KILOBAND_SOURCE_DIR;
  CaseSettings settings;
  settings.backends = {"cpu"};
  if (!opencl::list_devices().empty()) settings.backends.push_back("opencl:dpept-batch");
  settings.effort = Effort::kQuick;
  // Nothing may fail: what fails is rendered again, and the p-values of the first attempt would be lost.
  settings.rule.first = 1e-30;
  std::map<std::string, Series> series;
  for (Case& c : all_cases({root / "scenes", root / "validation/scenes", {}, {}})) {
    if (c.name != wanted) continue;
    c.scene.width = c.scene.height = 32;
    for (int seed = 1; seed <= seeds; ++seed) {
      settings.seed = static_cast<uint64_t>(seed);
      const CaseResult result = run_case(c, settings, {});
      if (!result.error.empty()) throw InputError(result.error);
      for (const PairingResult& r : result.pairings) {
        if (r.pairing.kind == Pairing::Kind::kPaired) continue;  // differences of rounding alone
        Series& s = series[r.pairing.a.label() + " / " + r.pairing.b.label()];
        s.p.push_back(p_of(r.comparison));
        for (const stats::TestVerdict& v : r.comparison.tests) s.tests[v.name].push_back(v.p);
      }
    }
  }
  for (const auto& [name, s] : series) print(name, s);
  if (argc > 3) write(argv[3], series);
  return series.empty() ? 2 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "null_rates: %s\n", error.what());
    return 3;
  }
}
