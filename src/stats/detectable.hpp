// What a passed test would have seen: the minimum detectable bias.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace kiloband::stats {

inline constexpr double kPower = 0.9;

/// Of a unit and channel, relative to |mean of A|: standard error of the difference,
/// and what counts as rounding. share, dof_a, dof_b as in Contrast; share -1: Student's law with dof.
struct RelativeError {
  float error = 0, slack = 0, dof = 0;
  uint32_t channel = 0;
  float share = -1, dof_a = 0, dof_b = 0;
};

/// Biases relative to the channel's mean that a test detects with probability kPower:
///     MDB = delta SE / mean + slack,
/// where the noncentral t with the shift delta is above the test's quantile at level / (2 tests) with
/// probability kPower: Bonferroni over units and channels (so it is stated too large rather than too small).
/// (The sum of two quantiles of Student's law in the place of delta was found in 67 % of the cases by 2
/// replicates, in 86 % by 8.)
struct Detectable {
  double typical = 0;  // median over units of the median channel
  double best = 0;     // smallest over units of the median channel
  double largest = 0;  // over units and channels
  std::size_t largest_channel = 0;
};

/// Collects units; computes when level and number of tests are known. Then alone it shows what bias an error
/// is worth: with 4 replicates t has to be 50 times that with 32. So of the values that are alike in
/// degrees of freedom and share, to an eighth of a power of two, that with the largest error is kept.
class DetectableBias {
 public:
  /// A unit; `value` is any of its values, the others by add_value().
  void add(RelativeError median, RelativeError value);
  void add_value(const RelativeError& value);
  /// All NaN if no unit was added.
  Detectable at(double level, double tests) const;

 private:
  std::vector<RelativeError> medians_;
  std::unordered_map<uint64_t, RelativeError> largest_;  // by class
};

}  // namespace kiloband::stats
