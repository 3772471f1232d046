// Random numbers of the tests themselves (rotations, permutations): the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace kiloband::stats {

/// SplitMix64 (Steele, Lea, Flood 2014): a counter through a mixing function.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t bits() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In (0, 1), never its ends.
  double uniform() { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53; }
  /// Below n; n far below 2^53, so that the bias does not count.
  uint64_t below(uint64_t n) { return static_cast<uint64_t>(uniform() * static_cast<double>(n)); }
  /// Standard normal (Box, Muller 1958); one of the pair is dropped.
  double normal() { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * std::numbers::pi * uniform()); }

 private:
  uint64_t state_;
};

/// Seed of a part of a test.
inline uint64_t mix_seed(uint64_t seed, uint64_t part) {
  Random random(seed ^ (part * 0xd1342543de82ef95u));
  return random.bits();
}

}  // namespace kiloband::stats
