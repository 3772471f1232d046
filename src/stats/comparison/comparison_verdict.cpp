#include "stats/comparison/comparison_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/error.hpp"

namespace kiloband::stats {
namespace {

constexpr uint32_t kWantedReplicates = 32;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

TestVerdict of_units(const std::string& name, const ScaleResult& result) {
  TestVerdict verdict{name, result.p};
  verdict.detectable = {kUnknown, kUnknown, kUnknown, 0};
  if (result.worst.p <= 1) verdict.worst = result.worst;
  return verdict;
}

double test_count(const ScaleResult& result) {
  return static_cast<double>(std::max<std::size_t>(1, result.entries.tested));
}

/// Names of tests that saw nothing.
using Untested = std::vector<std::string>;

void add_units(Comparison& c, const std::string& name, const ScaleResult& result, Untested& untested) {
  if (result.units + result.entries.constant > 0)
    c.tests.push_back(of_units(name, result));
  else
    untested.push_back(name);
}

std::string mean_test(Scale scale) {
  return std::string("mean/") + name_of(scale);
}

void add_means(Comparison& c, Untested& untested) {
  for (std::size_t i = 0; i < c.means.size(); ++i) add_units(c, mean_test(c.scales[i]), c.means[i], untested);
}

void add_variances(Comparison& c, Untested& untested) {
  for (std::size_t i = 0; i < c.variances.size(); ++i)
    add_units(c, std::string("variance/") + name_of(static_cast<Scale>(i)), c.variances[i], untested);
  for (const auto& [name, result] :
       {std::pair{"scatter/image", &c.pooled_scatter}, std::pair{"variance/image", &c.pooled_variance}}) {
    if (!*result) continue;
    if ((*result)->entries == 0) {
      untested.emplace_back(name);
      continue;
    }
    TestVerdict pooled{name, (*result)->p};
    pooled.detectable = {kUnknown, kUnknown, kUnknown, 0};
    c.tests.push_back(pooled);
  }
}

uint32_t fewest_replicates(const Comparison& c) {
  return c.kind == Kind::kTruth ? c.replicates_a : std::min(c.replicates_a, c.replicates_b);
}

/// Why the units of a scale were not tested; nothing if they were.
std::string missing_for_uniformity(const Comparison& c, const UniformityResult& result, Scale scale,
                                   bool one_distribution) {
  if (!one_distribution) return "the noise of the two sides need not have one distribution";
  const auto at = std::ranges::find(c.scales, scale) - c.scales.begin();
  if (c.kind == Kind::kTruth && c.means[static_cast<std::size_t>(at)].entries.thin > 0)
    return std::string("against a truth no ") + name_of(scale) +
           " may be left out, and some have too few contributions";
  if (fewest_replicates(c) < kUniformityReplicates)
    return std::to_string(kUniformityReplicates) + " replicates on every side are needed";
  if (result.units < kUniformityUnits)
    return std::to_string(result.units) + " " + name_of(scale) +
           "s vary and have contributions enough and all replicates, " + std::to_string(kUniformityUnits) +
           " are needed";
  if (c.alpha / kMostTests < kUniformityLevel)
    return "divisions of the replicates do not resolve so small an alpha";
  return {};
}

/// Images that are too small for it say nothing of it.
void add_uniformity(Comparison& c, std::optional<UniformityResult>& result, Scale scale,
                    bool one_distribution, std::vector<std::string>& notes) {
  if (!result) return;
  const std::string name = std::string("uniform/") + name_of(scale);
  const bool tiles = scale == Scale::kTile;
  const std::size_t units =
      std::size_t{tiles ? tiles_along(c.width) : c.width} * (tiles ? tiles_along(c.height) : c.height);
  const std::string missing = missing_for_uniformity(c, *result, scale, one_distribution);
  if (!missing.empty()) {
    if (units >= kUniformityUnits) notes.push_back(name + ": not tested, " + missing);
    result.reset();
    return;
  }
  TestVerdict verdict{name, result->p};
  verdict.detectable = {kUnknown, kUnknown, kUnknown, 0};
  c.tests.push_back(verdict);
}

/// Detectable biases need the levels.
void add_detectable(Comparison& c) {
  for (std::size_t i = 0; i < c.means.size(); ++i) {
    const auto test = std::ranges::find(c.tests, mean_test(c.scales[i]), &TestVerdict::name);
    if (test != c.tests.end()) test->detectable = c.means[i].errors.at(test->level, test_count(c.means[i]));
  }
  for (TestVerdict& test : c.tests) {
    const auto tests = static_cast<double>(c.channels + 1);
    if (test.name == "scatter/image") test.detectable = c.pooled_scatter->errors.at(test.level, tests);
    if (test.name == "variance/image") test.detectable = c.pooled_variance->errors.at(test.level, tests);
  }
}

double kurtosis(const std::vector<TailWeight>& tails) {
  const TailWeight& tail = tails[heaviest_channel(tails)];
  return tail.count > 0 ? static_cast<double>(tail.count) / tail.effective : 0;
}

/// What a failure of two different estimators may be besides a difference.
void add_unmet_paths_note(Comparison& c, const ComparisonOptions& options) {
  if (c.kind != Kind::kIndependent || options.variances || c.passed || c.tails_a.empty() || c.tails_b.empty())
    return;
  const auto fails = [&](bool image) {
    return std::ranges::any_of(c.tests, [&](const TestVerdict& test) {
      return !test.passed && test.name.ends_with("/image") == image;
    });
  };
  if (fails(true) || c.non_finite > 0) return;
  if (std::max(kurtosis(c.tails_a), kurtosis(c.tails_b)) <= kTruthKurtosis) return;
  c.notes.push_back(
      "pixels or tiles differ, the image does not: with noise of few bright paths one estimator may not have "
      "met those that the other has, and then states too small an error; more samples decide");
}

void add_notes(Comparison& c, const ComparisonOptions& options, bool same_sizes) {
  const auto say = [&](std::string text) { c.notes.push_back(std::move(text)); };
  const uint32_t fewest = fewest_replicates(c);
  if (fewest > 0 && fewest < kWantedReplicates)
    say(std::to_string(fewest) + " replicates on a side: " + std::to_string(kWantedReplicates) +
        " or more are wanted; the tests hold but see less");
  if (fewest > 0 && fewest < kPixelReplicates && options.fine_scales)
    say("mean/pixel: not tested, " + std::to_string(kPixelReplicates) +
        " replicates on every side are needed");
  const bool variances = c.kind == Kind::kIndependent && options.variances && fewest > 0;
  if (variances && c.replicates_a != c.replicates_b)
    say("variances were not compared: the sides have different numbers of replicates");
  else if (variances && !same_sizes)
    say("variances were not compared: the replicates of the two sides have different numbers of samples");
  else if (variances && options.fine_scales && fewest < kVarianceReplicates)
    say("variance/pixel, variance/tile: not tested, " + std::to_string(kVarianceReplicates) +
        " replicates on every side are needed");
  add_unmet_paths_note(c, options);
  if (c.kind == Kind::kPaired) say("variances were not compared: the sides are paired");
  for (std::size_t i = 0; i < c.means.size(); ++i) {
    if (c.scales[i] == Scale::kImage) continue;
    const std::string scale = name_of(c.scales[i]);
    const EntryCounts& n = c.means[i].entries;
    if (n.thin > 0)
      say(scale + "s: " + std::to_string(n.thin) + " of " +
          std::to_string(c.means[i].t_map.size() * c.channels) +
          " values have too few contributions and were " +
          (c.kind == Kind::kTruth ? "left to larger units" : "pooled"));
    if (n.unsampled > 0)
      say(scale + "s: " + std::to_string(n.unsampled) +
          " values have no error on a side and were not compared");
  }
}

void add_untested_note(Comparison& c, const Untested& untested) {
  if (untested.empty()) return;
  std::string names;
  for (const std::string& name : untested) names += (names.empty() ? "" : ", ") + name;
  c.notes.push_back(names + ": not tested, no value has enough contributions and replicates, or none varies");
}

std::string non_finite_note(const Comparison& c) {
  const std::string count = std::to_string(c.non_finite);
  if (c.replicates_a == 0)
    return count + " pixels have values that are not finite, or values on one side alone";
  if (c.kind == Kind::kTruth) return count + " replicate means or true values of pixels are not finite";
  return count + " replicate means of pixels are not finite";
}

}  // namespace

bool replicates_have_same_sizes(const UnitSample& a, const UnitSample& b) {
  double mean[2] = {0, 0};
  for (const UnitSample* side : {&a, &b}) {
    const auto [least, most] = std::ranges::minmax(side->weights);
    if (least == 0) return true;  // a replicate that lost its samples here says nothing
    if (most - least > std::max(1.0, 0.001 * most)) return false;
    for (const double w : side->weights) mean[side == &b] += w / static_cast<double>(side->replicates());
  }
  return std::abs(mean[0] - mean[1]) <= 0.001 * mean[0];
}

void add_image_means(const Contrast& contrast, Comparison& c) {
  c.image_a = contrast.a;
  c.image_b = contrast.b;
  for (const double v : contrast.variance) c.image_error.push_back(std::sqrt(v));
}

void leave_out_skewed(Comparison& c) {
  const double excess = kurtosis(c.tails_a) - 3;
  for (const Scale scale : {Scale::kTile, Scale::kPixel}) {
    const double pooled = scale == Scale::kTile ? kTileEdge * kTileEdge : 1;
    const auto found = std::ranges::find(c.scales, scale);
    if (found == c.scales.end() || !(excess / pooled > kTruthKurtosis - 3)) continue;
    c.means.erase(c.means.begin() + (found - c.scales.begin()));
    c.scales.erase(found);
    c.notes.push_back(
        std::string(name_of(scale)) +
        "s were not held against the truth: the noise is too skewed, or too unlike from one to another");
  }
}

bool is_different(const Comparison& c, double level) {
  const auto below = [level](const auto& result) { return result.p < level; };
  return c.non_finite > 0 || std::ranges::any_of(c.means, below) || std::ranges::any_of(c.variances, below) ||
         (c.pooled_scatter && below(*c.pooled_scatter)) || (c.pooled_variance && below(*c.pooled_variance));
}

void judge(Comparison& c, const ComparisonOptions& options, bool same_sizes) {
  c.alpha = options.alpha;
  Untested untested;
  add_means(c, untested);
  add_variances(c, untested);
  const bool one_distribution = c.kind == Kind::kTruth || (options.variances && same_sizes);
  std::vector<std::string> not_uniform;
  add_uniformity(c, c.uniform_pixels, Scale::kPixel, one_distribution, not_uniform);
  add_uniformity(c, c.uniform_tiles, Scale::kTile, one_distribution, not_uniform);
  if (c.tests.empty() && c.non_finite == 0)
    throw InputError("no pixel has values and errors on both sides: there is nothing to compare");
  const double level = options.alpha / static_cast<double>(std::max<std::size_t>(1, c.tests.size()));
  for (TestVerdict& test : c.tests) {
    test.level = level;
    test.passed = test.p >= level;
  }
  add_detectable(c);
  if (c.non_finite > 0) {
    c.tests.push_back({"finite", 0, level, false, {kUnknown, kUnknown, kUnknown, 0}, std::nullopt});
    c.notes.push_back(non_finite_note(c));
  }
  c.passed = std::ranges::all_of(c.tests, &TestVerdict::passed);
  add_notes(c, options, same_sizes);
  add_untested_note(c, untested);
  for (std::string& note : not_uniform) c.notes.push_back(std::move(note));
}

const TestVerdict& Comparison::decisive() const {
  return *std::ranges::min_element(tests, [](const TestVerdict& x, const TestVerdict& y) {
    return x.passed != y.passed ? !x.passed : x.p < y.p;
  });
}

}  // namespace kiloband::stats
