#include "tests/support/simulated_image.hpp"

#include <cmath>
#include <stdexcept>

namespace kiloband::test {
namespace {

double draw_sample(const std::string& distribution, stats::Random& random) {
  if (distribution == "normal") return 1 + random.normal();
  if (distribution == "exponential") return -std::log(random.uniform());
  if (distribution == "rare") return random.uniform() < 0.05 ? 20 : 0;
  if (distribution == "lognormal") return std::exp(1.5 * random.normal());
  if (distribution == "firefly") {
    const double usual = -std::log(random.uniform());
    return usual + (random.uniform() < 1e-3 ? 500 : 0);
  }
  if (distribution == "pareto") return std::pow(random.uniform(), -1 / 2.1);
  throw std::logic_error("BatchPool: unknown distribution");
}

}  // namespace

BatchPool::BatchPool(const std::string& distribution, uint32_t samples, std::size_t size)
    : samples_(samples) {
  stats::Random random(samples * 7919 + size);
  std::vector<double> means(size);
  double total = 0;
  for (double& mean : means) {
    for (uint32_t s = 0; s < samples; ++s) mean += draw_sample(distribution, random) / samples;
    total += mean;
  }
  for (const double mean : means)
    values_.push_back(static_cast<float>(mean * static_cast<double>(size) / total));
}

stats::ReplicateImage simulate(const SimulatedImage& what, const BatchPool& pool, uint64_t seed) {
  stats::Random random(stats::mix_seed(seed, 77));
  stats::ReplicateImage image{what.width, what.height, what.channels, what.replicates, {}, {}};
  image.means.reserve(image.pixels() * what.replicates * what.channels);
  image.samples.assign(image.pixels() * what.replicates, pool.samples());
  const uint32_t blocks_x = (what.width + 31) / 32, blocks_y = (what.height + 31) / 32;
  const double own = 1 - what.common - what.block_common;
  for (uint32_t r = 0; r < what.replicates; ++r) {
    std::vector<double> blocks(std::size_t{blocks_x} * blocks_y * what.channels);
    for (double& block : blocks) block = pool.draw(random);
    for (uint32_t y = 0; y < what.height; ++y) {
      for (uint32_t x = 0; x < what.width; ++x) {
        const double shared = what.common * pool.draw(random);
        const double* block = &blocks[(std::size_t{y / 32} * blocks_x + x / 32) * what.channels];
        for (std::size_t c = 0; c < what.channels; ++c) {
          double value = shared + what.block_common * block[c] + (own > 1e-9 ? own * pool.draw(random) : 0);
          if (what.spread) value = 1 + what.spread(x, y, c) * (value - 1);
          if (what.mean) value *= what.mean(x, y, c);
          image.means.push_back(static_cast<float>(value * (1 + 0.5 * static_cast<double>(c))));
        }
      }
    }
  }
  return image;
}

}  // namespace kiloband::test
