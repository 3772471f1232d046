// With equal seeds both backends follow the same paths.
//
// Every scene of the zoo, both samplers with both wavelength modes, several replicates and samples: 24576
// paths a scene. A path has parted if its triangles, lobes, lights, rows or texels differ anywhere, or if its
// value in a channel differs by more than 1e-4 of its largest channel
// (values_agree() says what is asked of paths near 0).
//   decisions     at most 0.1 % of a scene's paths may differ, 2 % with long specular chains, 0.5 % with
//                 plumes: where the cells of a segment end follows about a hundred comparisons, each of which
//                 falls otherwise if it lies within the rounding of the ray's two ends
//   with values   0.1 % on rough scenes, 2 % with long specular chains, and 0.5 % with curved reflectors: a
//                 ball of radius r that is hit from d metres under cos multiplies an error of the hit point
//                 by 2 d / (r cos). With 5e-7 m, a unit in the last place at the camera's 4 m, two balls are
//                 enough for 1e-4; neither backend is nearer to the truth. 1 % with plumes: other cells are
//                 other approximations, within the tolerance of shared/plume.h.
// These are limits on counts, not estimates.
//
// Paths that part do so because rays graze edges or numbers fall on a threshold; that must not favour a
// value. The mean of OpenCL's value minus the CPU's over the parted paths is held against 0 by a paired
// t-test. Error rate 1e-4 over all scenes together (Sidak); the detectable bias of a scene's mean is printed
// with its counts.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "backend_images.hpp"
#include "path_comparison.hpp"
#include "shared/sampler.h"
#include "tests/support/render_harness.hpp"

namespace kiloband::test::parity_test {
namespace {

constexpr double kErrorRate = 1e-4;
constexpr uint32_t kReplicates = 8, kSamplesOfAConfiguration = 6;

struct Configuration {
  SamplerType sampler;
  WavelengthMode wavelengths;
  uint64_t seed;
  RoughDispersion rough_dispersion = RoughDispersion::kSpectralMis;
};
constexpr Configuration kConfigurations[] = {
    {SamplerType::kSobol, WavelengthMode::kShared, 11},
    {SamplerType::kSobol, WavelengthMode::kPerPath, 0x123456789abcdefu},
    {SamplerType::kIndependent, WavelengthMode::kShared, 13, RoughDispersion::kDegrade},
    {SamplerType::kIndependent, WavelengthMode::kPerPath, 14},
};

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// What a scene's paths come to.
struct Tally {
  std::size_t paths = 0;
  std::array<std::size_t, 4> parted{};  // by Parting
  double sum = 0;                       // of the CPU's values
  std::vector<double> differences;      // of parted paths

  std::size_t all_parted() const { return paths - parted[0]; }
  double fraction(std::size_t n) const { return static_cast<double>(n) / static_cast<double>(paths); }
  double mean() const { return paths > 0 ? sum / static_cast<double>(paths) : 0; }
};

/// The wavelength offset that a path is evaluated with.
double offset_of(const FlatScene& scene, const SamplingSettings& s, uint32_t x, uint32_t y,
                 const SampleRange& range) {
  if (s.wavelengths == WavelengthMode::kShared)
    return kb_shared_mu(s.seed, range.replicate, x / kBlockSize, y / kBlockSize, range.first);
  const uint32_t sampler = s.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  return kb_path_mu(sampler, s.seed, y * scene.camera.film_width + x,
                    range.replicate + range.first * s.replicates, range.replicate, range.first);
}

class Parity : public testing::TestWithParam<std::string> {
 protected:
  void compare(const FlatScene& scene, const Configuration& c) {
    const SamplingSettings settings{c.wavelengths, c.sampler, c.seed, kReplicates, c.rough_dispersion};
    const auto cpu = make_zoo_backend("cpu", scene, {}, settings);
    const auto opencl = make_zoo_backend("opencl:dpept-path", scene, {}, settings);
    for (const PixelRect& rect : cut_into_blocks(film_rect(scene))) {
      for (uint32_t i = 0; i < kSamplesOfAConfiguration; ++i) {
        const SampleRange range{(3 * i) % kReplicates, i, 1};
        const std::vector<TracedPath> a = cpu->trace(rect, range), b = opencl->trace(rect, range);
        ASSERT_EQ(a.size(), rect.pixels());
        ASSERT_EQ(b.size(), rect.pixels());
        for (uint32_t p = 0; p < a.size(); ++p) {
          const uint32_t x = rect.x0 + p % rect.width, y = rect.y0 + p / rect.width;
          add(scene, a[p], b[p], offset_of(scene, settings, x, y, range));
        }
      }
    }
  }

  void add(const FlatScene& scene, const TracedPath& a, const TracedPath& b, double mu) {
    const std::vector<double> values = path_values(scene, a, mu), others = path_values(scene, b, mu);
    Parting parting = compare_decisions(a, b);
    if (parting == Parting::kNone && !values_agree(values, others, 1e-3 * tally_.mean()))
      parting = Parting::kValues;
    ++tally_.paths;
    ++tally_.parted[static_cast<std::size_t>(parting)];
    tally_.sum += mean_of(values);
    if (parting != Parting::kNone) tally_.differences.push_back(mean_of(others) - mean_of(values));
  }

  Tally tally_;
  ZooFolder folder_;
};

/// The part of a scene's paths that may part.
double budget_of(Chains chains) {
  if (chains == Chains::kSpecular) return 0.02;
  if (chains == Chains::kPlume) return 0.01;
  return chains == Chains::kCurved ? 0.005 : 0.001;
}

/// The part of it that may differ by decisions.
double decision_budget_of(Chains chains) {
  if (chains == Chains::kSpecular) return 0.02;
  return chains == Chains::kPlume ? 0.005 : 0.001;
}

/// Mean and its standard error.
struct Estimate {
  double mean = 0, error = 0;
};
Estimate estimate(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double v : values) sum += v;
  for (const double v : values) squares += (v - sum / n) * (v - sum / n);
  return {sum / n, std::sqrt(squares / (n * (n - 1)))};
}

TEST_P(Parity, PathsTakeTheSameDecisionsAndWeights) {
  const ZooScene& zoo = zoo_scene(GetParam());
  const FlatScene scene = folder_.flatten(zoo);
  for (const Configuration& c : kConfigurations) compare(scene, c);
  const double budget = budget_of(zoo.chains);
  const double fraction = tally_.fraction(tally_.all_parted());
  const double decisions = tally_.fraction(tally_.parted[1] + tally_.parted[2]);
  std::printf("%-18s %zu paths, parted %.4f %%: %zu by hits, %zu by decisions, %zu by values\n",
              zoo.name.c_str(), tally_.paths, 100 * fraction, tally_.parted[1], tally_.parted[2],
              tally_.parted[3]);
  EXPECT_GT(tally_.mean(), 0);
  EXPECT_LE(decisions, decision_budget_of(zoo.chains));
  EXPECT_LE(fraction, budget);
  if (tally_.differences.size() < 2) return;  // nothing to take a mean of
  const Estimate d = estimate(tally_.differences);
  const double critical =
      critical_t(kErrorRate, scene_zoo().size(), static_cast<uint32_t>(tally_.differences.size()));
  std::printf("%-18s their values: bias of the scene's mean %.2g +- %.2g, detectable %.2g\n", "",
              d.mean * fraction / tally_.mean(), d.error * fraction / tally_.mean(),
              critical * d.error * fraction / tally_.mean());
  EXPECT_LE(std::abs(d.mean), critical * d.error + 1e-7 * tally_.mean());
}

INSTANTIATE_TEST_SUITE_P(Zoo, Parity, testing::ValuesIn(zoo_names()), [](const auto& p) { return p.param; });

}  // namespace
}  // namespace kiloband::test::parity_test
