// Means and replicate variances of a spectral image.
//
// N samples of a pixel are dealt to R independently randomised replicates of sizes n_r (sum N). With the replicate means
// m_r, the pixel's value is m = sum n_r m_r / N and the variance of that mean is estimated by
//     V = sum n_r (m_r - m)^2 / (N (R - 1)),
// which is s^2 / R for equal sizes and is unbiased for unequal ones if Var(m_r) is proportional to 1 / n_r. It has R - 1
// degrees of freedom; with R = 1 there is none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kiloband {

/// Weighted running mean and sum of squares of replicate means (West 1979), for many channels of many units at once.
/// Units are pixels, 8x8 tiles or the image. Results do not depend on how units are spread over threads; replicates of
/// one unit are added in order. Mean and m2 are float32; one replicate adds a rounding error below 1e-7 relative.
class ReplicateMoments {
 public:
  /// variance false: only means are kept.
  ReplicateMoments(std::size_t units, std::size_t channels, bool variance);

  /// Adds a replicate mean of n samples (n = 0: nothing) of a unit: `means`, one entry per channel, times `factor`.
  void add(std::size_t unit, uint64_t n, std::span<const float> means, float factor = 1);

  /// A unit becomes what somebody else has added up as add() does. m2: empty where none is kept
  void set(std::size_t unit, uint64_t samples, uint32_t replicates, std::span<const float> mean,
           std::span<const float> m2);

  /// Forgets all replicates; mean() of a unit is undefined until its next.
  void restart();

  std::size_t units() const;
  std::size_t channels() const;
  uint64_t samples(std::size_t unit) const;             // N
  uint32_t replicates(std::size_t unit) const;          // R, those with n > 0
  std::span<const float> mean(std::size_t unit) const;  // 0 for N = 0
  /// Variance of the mean; NaN with fewer than two replicates. out has one entry per channel.
  void variance_of_mean(std::size_t unit, std::span<float> out) const;

 private:
  std::size_t channels_;
  bool variance_;
  std::vector<float> mean_, m2_;
  std::vector<uint64_t> samples_;
  std::vector<uint32_t> replicates_;
};

/// How N samples are dealt to replicates: sizes differ by at most one; with fewer than 2 samples per replicate R is lowered.
/// Replicate r has the samples r, r + R, r + 2R ... of the pixel.
struct ReplicatePlan {
  uint64_t samples = 0;
  uint32_t replicates = 1;

  /// wanted_replicates  0 is 1
  static ReplicatePlan deal(uint64_t samples, uint32_t wanted_replicates);
  /// Samples of a replicate.
  /// throws std::logic_error  there is no such replicate
  uint64_t size(uint32_t replicate) const;
};

}  // namespace kiloband
