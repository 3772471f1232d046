// How much work a launch may have so that it stays short: display drivers kill long ones.
#pragma once

#include <cstdint>

namespace kiloband::opencl {

/// A limit on the units (slots, paths, samples of a pixel) of a launch: small at first, then by the time that units are measured
/// to take, at most four times more from one look to the next. Aims at half of the budget, as the next part
/// of an image may be harder. What is rendered does not depend on it: pixels are added up sample by sample
/// whatever the launches.
class LaunchPace {
 public:
  /// seconds  budget of a launch; first: units to begin with; fewest, most: what the limit stays within
  LaunchPace(double seconds, uint64_t first, uint64_t fewest, uint64_t most);

  uint64_t limit() const { return limit_; }
  /// The longest launch of `units` took this long (0: not measured, taken for short).
  void learn(uint64_t units, double seconds);

 private:
  double target_;  // seconds
  uint64_t fewest_, most_, limit_;
  double rate_ = 0;  // seconds per unit; a hard part is forgotten by halves
};

}  // namespace kiloband::opencl
