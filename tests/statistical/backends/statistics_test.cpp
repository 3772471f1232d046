// With different seeds the backends agree as two estimates of the same image do:
// in their means and their variances.
//
// Every scene of the zoo: the CPU against each OpenCL method, R = 32 replicates of 2 samples on either side.
// All pixels, all tiles of 8 x 8 and the whole image are tested in every channel; none is forgiven.
//   means      two-sample t-test of the replicate means, 2 R - 2 degrees of freedom. Both sides have one
//              distribution if the backends agree, so the difference is symmetric however skewed it is. Added
//              to its error is 1e-5 of the mean for rounding, which is all that differs where a pixel is
//              constant.
//   variances  Brown-Forsythe: the distances of the replicate means from their pixel's median, in units of
//              the pixel's mean distance on both sides, averaged over the pixels of a tile or of the image.
//              That gives a number per replicate (pixels share wavelengths, replicates share nothing), to
//              which the same t-test applies.
// Family-wise error rate 1e-4 over all scenes: a third each for all tests of pixels, of tiles and of images
// (Sidak). What the tests of the image would detect is printed: bias of the mean, and of the standard
// deviation, both relative, in the worst channel. (Where all noise is that of the shared wavelengths,
// standard deviations say little; the run with wavelengths of each path tells.
// Far smaller biases show in parity_test.cpp.)
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "backend_images.hpp"
#include "tests/support/render_harness.hpp"

namespace kiloband::test::statistics_test {
namespace {

constexpr double kErrorRate = 1e-4, kRounding = 1e-5;
constexpr uint32_t kReplicates = 32, kSamples = 2;
constexpr uint32_t kTiles = 4;  // in each direction, of 32 pixels

using Replicates = std::vector<double>;  // a number per replicate

/// A set of pixels whose mean is tested.
using Unit = std::vector<uint32_t>;

Unit tile(uint32_t index) {
  Unit pixels;
  for (uint32_t i = 0; i < kTileSize * kTileSize; ++i) {
    const uint32_t x = index % kTiles * kTileSize + i % kTileSize;
    pixels.push_back((index / kTiles * kTileSize + i / kTileSize) * kTiles * kTileSize + x);
  }
  return pixels;
}

/// The tiles, then the image.
std::vector<Unit> coarse_units() {
  std::vector<Unit> units;
  Unit image;
  for (uint32_t i = 0; i < kTiles * kTiles; ++i) {
    units.push_back(tile(i));
    image.insert(image.end(), units.back().begin(), units.back().end());
  }
  units.push_back(image);
  return units;
}

Replicates unit_means(const Image& image, const Unit& unit, std::size_t channel) {
  Replicates means(image.replicates);
  for (uint32_t r = 0; r < image.replicates; ++r) {
    for (const uint32_t p : unit) means[r] += image.at(r, p, channel);
    means[r] /= static_cast<double>(unit.size());
  }
  return means;
}

double median(Replicates values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// Distances from the median.
Replicates distances(const Replicates& values) {
  const double middle = median(values);
  Replicates d;
  for (const double v : values) d.push_back(std::abs(v - middle));
  return d;
}

double mean_of(const Replicates& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double variance_of_mean(const Replicates& values) {
  const double mean = mean_of(values);
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const auto n = static_cast<double>(values.size());
  return squares / (n * (n - 1));
}

/// A two-sample t-test. `rounding`: what the means may differ by in any case.
struct Comparison {
  double excess = 0;  // of the difference, in critical differences; above 1: they differ
  double detectable = 0;
};
Comparison compare(const Replicates& a, const Replicates& b, double critical, double rounding) {
  const double limit = critical * std::sqrt(variance_of_mean(a) + variance_of_mean(b)) + rounding;
  const double difference = std::abs(mean_of(a) - mean_of(b));
  const double scale = std::max(std::abs(mean_of(a)), std::abs(mean_of(b)));
  return {difference > 0 ? difference / limit : 0, scale > 0 ? limit / scale : 0};
}

Comparison compare_means(const Image& a, const Image& b, const Unit& unit, std::size_t channel,
                         double critical) {
  const Replicates x = unit_means(a, unit, channel), y = unit_means(b, unit, channel);
  return compare(x, y, critical, kRounding * std::max(std::abs(mean_of(x)), std::abs(mean_of(y))));
}

/// Adds the distances of one pixel in units of their mean.
/// Where it is below rounding, both sides are constant.
void add_distances(const Image& a, const Image& b, uint32_t pixel, std::size_t channel, Replicates& sum_a,
                   Replicates& sum_b) {
  const Replicates x = unit_means(a, {pixel}, channel), y = unit_means(b, {pixel}, channel);
  const Replicates dx = distances(x), dy = distances(y);
  const double unit = 0.5 * (mean_of(dx) + mean_of(dy));
  if (unit <= kRounding * std::abs(mean_of(x))) return;
  for (std::size_t r = 0; r < dx.size(); ++r) {
    sum_a[r] += dx[r] / unit;
    sum_b[r] += dy[r] / unit;
  }
}

Comparison compare_variances(const Image& a, const Image& b, const Unit& unit, std::size_t channel,
                             double critical) {
  Replicates x(a.replicates), y(b.replicates);
  for (const uint32_t p : unit) add_distances(a, b, p, channel, x, y);
  return compare(x, y, critical, 0);
}

struct Pairing {
  const char* method;
  SamplerType sampler;
  WavelengthMode wavelengths;
  uint64_t seed;
};
constexpr Pairing kPairings[] = {
    {"opencl:pt", SamplerType::kSobol, WavelengthMode::kShared, 101},
    {"opencl:dpept-path", SamplerType::kIndependent, WavelengthMode::kPerPath, 102},
    {"opencl:dpept-batch", SamplerType::kSobol, WavelengthMode::kShared, 103}};

/// Critical t where every pair of images has `tests` of a kind in each channel.
double critical_of(std::size_t tests, std::size_t channels) {
  return critical_t(kErrorRate / 3, tests * channels * std::size(kPairings) * scene_zoo().size(),
                    2 * kReplicates - 1);
}

class Statistics : public testing::TestWithParam<std::string> {
 protected:
  Image image(const std::string& backend, const Pairing& pairing, uint64_t seed) const {
    const SamplingSettings settings{pairing.wavelengths, pairing.sampler, seed, kReplicates};
    return render_image(*make_zoo_backend(backend, scene_, {}, settings), scene_, kReplicates, kSamples);
  }

  void expect_equal(const Image& cpu, const Image& opencl, const std::string& method) const {
    const std::vector<Unit> coarse = coarse_units();
    const double of_pixels = critical_of(cpu.pixels(), cpu.channels);
    const double of_tiles = critical_of(2 * (coarse.size() - 1), cpu.channels);
    const double of_image = critical_of(2, cpu.channels);
    double mean_bias = 0, deviation_bias = 0;
    for (std::size_t k = 0; k < cpu.channels; ++k) {
      for (uint32_t p = 0; p < cpu.pixels(); ++p)
        EXPECT_LE(compare_means(cpu, opencl, {p}, k, of_pixels).excess, 1)
            << method << ", pixel " << p << ", " << k;
      for (const Unit& unit : coarse) {
        const double critical = &unit == &coarse.back() ? of_image : of_tiles;
        const Comparison means = compare_means(cpu, opencl, unit, k, critical);
        const Comparison variances = compare_variances(cpu, opencl, unit, k, critical);
        EXPECT_LE(means.excess, 1) << method << ", mean from pixel " << unit[0] << " on, " << k;
        EXPECT_LE(variances.excess, 1) << method << ", variance from pixel " << unit[0] << " on, " << k;
        if (&unit != &coarse.back()) continue;
        mean_bias = std::max(mean_bias, means.detectable);
        deviation_bias = std::max(deviation_bias, variances.detectable);
      }
    }
    std::printf("%-18s %-18s detectable bias: mean %.2g %%, standard deviation %.2g %%\n", GetParam().c_str(),
                method.c_str(), 100 * mean_bias, 100 * deviation_bias);
  }

  ZooFolder folder_;
  FlatScene scene_ = folder_.flatten(zoo_scene(GetParam()));
};

TEST_P(Statistics, MeansAndVariancesAgree) {
  ASSERT_EQ(film_rect(scene_).width, kTiles * kTileSize);
  ASSERT_EQ(film_rect(scene_).height, kTiles * kTileSize);
  for (const Pairing& pairing : kPairings) {
    const Image cpu = image("cpu", pairing, 7), opencl = image(pairing.method, pairing, pairing.seed);
    EXPECT_EQ(cpu.invalid_samples, 0u);
    EXPECT_EQ(opencl.invalid_samples, 0u);
    expect_equal(cpu, opencl, pairing.method);
  }
}

INSTANTIATE_TEST_SUITE_P(Zoo, Statistics, testing::ValuesIn(zoo_names()),
                         [](const auto& p) { return p.param; });

}  // namespace
}  // namespace kiloband::test::statistics_test
