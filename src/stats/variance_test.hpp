// Do the two sides scatter alike? A wrong weight can leave every mean right and the variance wrong.
//
// F tests take the fourth moment of a normal distribution for granted and fail on renders. Here
//  * per unit: after Brown and Forsythe (J. Am. Stat. Assoc. 69, 1974) the distances |m_r - median| of both
//    sides, compared by t with R_A + R_B - 2 degrees of freedom (sides that agree have one distribution);
//    over channels and units as for means. The median is that of both sides together: a mean that differs is
//    seen here too, but medians of their own lie on other steps where few paths arrive (95 % false alarms).
//    Of the roots of the distances: with 32 replicates the t of the distances themselves cannot pass 7.5,
//    however different the variances are, and thousands of pixels demand more.
//  * pooled over the image, in two ways that see different things. With d_r = |m_r - median of both sides
//    together|
//    - scatter: 2 d_r / s, d_r cut at kScatterCut times their median and s the mean of both sides. Does not
//      feel the tails, so that a change of all that is usual is seen in the noisiest images. The cut pulls
//      the ratio towards 1, by a tenth of its logarithm for normal noise;
//    - variance: d_r^2 / s, s the mean of both sides. Feels the tails.
//    Both are averaged over the pixels, replicate by replicate, and compared as means are: whatever pixels
//    have in common (wavelength offsets, scrambles) is common to a replicate and part of its error; bright
//    and dark pixels count alike; no pixel counts for more than its number of replicates; nothing knows the
//    sides apart, so the level holds for any distribution that they share. (Medians of their own give 4 %
//    instead of 1 % for lognormal noise; a jackknife of ln s^2 has more than 10 % where two fireflies meet
//    all pixels.) The mean over the channels is tested as one channel more.
// Replicate means scatter with 1 / n_r: both sides must have the same number of samples in a replicate. Sides
// that are not the same estimator (other samplers, wavelength modes) may differ
// in variance without being wrong.
#pragma once

#include "stats/scale_test.hpp"

namespace kiloband::stats {

/// sqrt(n_r / mean n) |m_r - median|, as means of weight 1;
/// the median is that of `other` too if there is one.
UnitSample deviations_from_median(const UnitSample& sample, const UnitSample* other = nullptr);

/// Contrast of sqrt|m_r - median|; what of a distance is below `rounding` of the mean counts as none.
Contrast deviation_contrast(const UnitSample& a, const UnitSample& b, double rounding);

/// On a side, for the tests of units. With few replicates the two middle values of both sides together, which
/// are equally far from the median, often are all that one side has, and their distances do not vary: 2
/// replicates raised 30 % false alarms at 1e-3, 3 raised 2 %.
inline constexpr uint32_t kVarianceReplicates = 8;

/// Where the deviations of the scatter test are cut: 2.7 standard deviations of normal noise.
inline constexpr double kScatterCut = 4;

/// Channel number of the mean over all channels.
inline constexpr std::size_t kAllChannels = static_cast<std::size_t>(-1);

/// One of the two pooled tests. Where nothing took part p is 1.
struct PooledVariance {
  std::size_t entries = 0;  // pixels times channels that took part
  std::size_t skipped = 0;  // those that hardly vary
  double p = 1;             // over channels
  std::size_t channel = 0;  // the worst, or kAllChannels
  double ratio = 1;         // of the variances there, A / B
  double log_error = 0;     // standard error of ln ratio
  double t = 0, dof = 0;
  double ratio_all = 1, log_error_all = 0;  // geometric mean over the channels
  DetectableBias errors;                    // of ln ratio: about the relative change of variance
};

/// Averages numbers of replicates over pixels.
class PooledReplicates {
 public:
  /// power: the numbers are proportional to the variance to the power 1 / power, and have the mean `power`.
  PooledReplicates(std::size_t channels, std::size_t replicates_a, std::size_t replicates_b, double power);
  void add(std::size_t channel, const std::vector<double>& a, const std::vector<double>& b);
  void skip() { ++skipped_; }
  PooledVariance finish(uint64_t seed) const;

 private:
  double ratio_of(double difference) const;

  std::size_t channels_, skipped_ = 0;
  double power_;
  std::vector<double> sums_a_, sums_b_;  // [replicate][channel]
  std::vector<std::size_t> counts_;      // [channel]
};

class PooledVarianceTest {
 public:
  PooledVarianceTest(std::size_t channels, std::size_t replicates_a, std::size_t replicates_b);
  /// A pixel of both sides; wanted as in ScaleTest.
  void add(const UnitSample& a, const UnitSample& b, const std::vector<bool>& wanted, double rounding);
  PooledVariance scatter(uint64_t seed) const { return scatter_.finish(seed); }
  PooledVariance variance(uint64_t seed) const { return variance_.finish(seed); }

 private:
  std::size_t channels_;
  PooledReplicates scatter_, variance_;
};

}  // namespace kiloband::stats
