// Images of random numbers with known distributions: what the statistical tests are tested with.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stats/comparison/replicate_image.hpp"
#include "stats/random.hpp"

namespace kiloband::test {

/// Means of batches of `samples` samples of a distribution, scaled to mean 1. A pool of them is computed
/// once; images draw from it, which is fast and leaves the mean exactly known.
///   "normal"     N(1, 1)
///   "exponential"
///   "rare"       5 % of the samples are 20, others 0
///   "lognormal"  exp of N(., 1.5)
///   "firefly"    exponential, and 1e-3 of the samples 500 more (mean 1.5, scaled to 1)
///   "pareto"     index 2.1: hardly a variance
class BatchPool {
 public:
  BatchPool(const std::string& distribution, uint32_t samples, std::size_t size = std::size_t{1} << 17);
  float draw(stats::Random& random) const { return values_[random.below(values_.size())]; }
  uint32_t samples() const { return samples_; }

 private:
  uint32_t samples_;
  std::vector<float> values_;
};

struct SimulatedImage {
  uint32_t width = 64, height = 64, replicates = 32;
  std::size_t channels = 4;
  double common = 0.7;      // part of each value that all channels of a pixel share
  double block_common = 0;  // part that a block of 32x32 pixels shares, as wavelength offsets make it
  /// Factor on the mean of a pixel; and on the standard deviation.
  std::function<double(uint32_t x, uint32_t y, std::size_t channel)> mean, spread;
};

/// Channel c has the mean 1 + c / 2 before `mean`.
stats::ReplicateImage simulate(const SimulatedImage& what, const BatchPool& pool, uint64_t seed);

}  // namespace kiloband::test
