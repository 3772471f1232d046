// Are the p-values of many units those of chance? Many small biases that no single unit shows move them all.
//
// One channel of each unit (chosen at random), its |t|. The distribution F of |t| among the units is compared
// with F_0, that under random divisions of the replicates into the two sides, the SAME division for all units
// (for a known truth: random signs): D = sup (F_0 - F), one-sided, since biases only enlarge |t|. The p-value
// is that of further divisions: where both sides have one distribution (for a truth: one that is symmetric
// about it) the observed division is one of them like any other, whatever units have in common and however
// heavy the tails are, so p is exact. (A law for D would need the number of units that count. Units of a
// block share wavelength offsets and scrambles; the part that is common to all shifts all |t| at once, with a
// tail that no scale of Kolmogorov's law has: 5 % false alarms instead of 10^-4 where a fifth of the variance
// is common.) Divisions are drawn until kUniformityHits of them have such a D (Besag and Clifford, Biometrika
// 78, 1991: p = hits / divisions, exact, too), some hundred mostly, or until kUniformityBeyond / level have
// been drawn (p = (1 + hits) / (1 + divisions)). A division of 4096 units and 64 replicates takes 50 us.
// Sides of different estimators have no common distribution, and thousands of units see that the law of |t|
// is not that of the divisions: noise that differs by a factor of 0.3 raised 100 % false alarms at 1 %
// (lognormal, 16 replicates a side; 90 % with 32), near-normal noise and a factor of 0.1 still 5 %. They are
// not tested. What counts as rounding is taken from the observed differences alone.
#pragma once

#include <cstdint>
#include <vector>

#include "stats/contrast.hpp"

namespace kiloband::stats {

inline constexpr std::size_t kUniformityUnits = 1000;      // at least
inline constexpr std::size_t kUniformityMostUnits = 4096;  // more are thinned out to so many
inline constexpr uint32_t kUniformityReplicates = 16;  // on a side, at least: fewer have too few divisions
inline constexpr int kReferenceDivisions = 128;        // that F_0 is made of
inline constexpr int kUniformityHits = 10;
inline constexpr double kUniformityBeyond = 4;
inline constexpr std::size_t kMostDivisions = std::size_t{1} << 22;  // three minutes of a processor

/// The level where other tests have found a difference.
inline constexpr double kUniformityCoarse = 1e-3;

/// The smallest level that kMostDivisions can tell.
inline constexpr double kUniformityLevel = 2.0 / static_cast<double>(kMostDivisions);

struct UniformityResult {
  std::size_t units = 0;
  double distance = 0;           // D
  double p = 1;                  // 1 where there are too few units
  std::vector<double> p_values;  // Student's p of the units: for histograms and QQ plots
};

class Uniformity {
 public:
  explicit Uniformity(uint64_t seed) : seed_(seed) {}

  /// Of both sides all replicates must have samples; units in which no channel has contributions enough and
  /// varies are left out. Of more than kUniformityMostUnits so many stay, chosen at random.
  void add(const Contrast& contrast, const UnitSample& a, const UnitSample& b);
  /// A truth; wanted as in ScaleTest.
  void add(const Contrast& contrast, const UnitSample& a, const std::vector<bool>& wanted);
  /// level: below which p will be called a difference, at least kUniformityLevel.
  UniformityResult finish(double level);

 private:
  struct Unit {
    uint64_t order = 0;  // random; the smallest stay
    std::size_t index = 0;
    std::size_t first = 0;       // replicates of A
    std::vector<double> values;  // of A, then of B; differences from a truth
    double slack = 0, p = 1;
  };
  bool next(uint64_t& order);
  void keep(Unit unit);

  uint64_t seed_;
  std::size_t seen_ = 0;
  std::vector<Unit> units_;  // a heap whose front has the largest order
};

}  // namespace kiloband::stats
