// Are the p-values of many units those of chance? Many small biases that no single unit shows move them all.
//
// One channel of each unit (chosen at random), its |t|. The distribution of |t| among the units is compared
// with that under random divisions of the replicates into the two sides, the SAME division for all units (for
// a known truth: random signs): D = sup |F - F_0|, as Kolmogorov and Smirnov. So heavy tails, for which
// Student's law is not exact, do no harm. Units of a block share wavelength offsets and scrambles, so D is
// larger than for independent ones: the number of units that count, n_eff, is the one for which the mean of
// sqrt(n_eff) D over the divisions is that of Kolmogorov's law.
#pragma once

#include <cstdint>
#include <vector>

#include "stats/contrast.hpp"

namespace kiloband::stats {

inline constexpr std::size_t kUniformityUnits = 1000;      // at least
inline constexpr std::size_t kUniformityMostUnits = 4096;  // more are thinned out
inline constexpr int kDivisions = 49;

struct UniformityResult {
  std::size_t units = 0;
  double distance = 0;  // D
  double p = 1;
  std::vector<double> p_values;  // Student's p of the units, unsorted: for histograms and QQ plots
};

class Uniformity {
 public:
  /// units: how many there will be at most; they are thinned out to about kUniformityMostUnits.
  Uniformity(std::size_t units, uint64_t seed);

  /// wanted as in ScaleTest. Units without a channel that varies are left out.
  void add(const Contrast& contrast, const UnitSample& a, const UnitSample& b,
           const std::vector<bool>& wanted);
  void add(const Contrast& contrast, const UnitSample& a, const std::vector<bool>& wanted);
  UniformityResult finish();

 private:
  struct Unit {
    std::vector<double> a, b;  // values of the replicates; b empty: differences from the truth
  };
  std::ptrdiff_t choose(const Contrast& contrast, const std::vector<bool>& wanted);

  double keep_;
  uint64_t seed_, seen_ = 0;
  std::vector<Unit> units_;
  UniformityResult result_;
};

}  // namespace kiloband::stats
