// The one figure that says how far a render is from converged: RMS standard error over image mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace kiloband {

/// Gathers means and variances of the mean of all pixels, band by band.
class ErrorSums {
 public:
  explicit ErrorSums(std::size_t bands) : bands_(bands) {}

  /// A pixel's value in a band. A variance of NaN (fewer than two replicates with a valid sample) leaves the
  /// pixel out of this band; one that is too large for a float, infinity, makes the band's error infinite.
  void add(std::size_t band, double mean, double variance);
  /// sqrt(mean variance) / mean over the pixels, the largest over the bands whose mean is positive; none
  /// without such a band.
  std::optional<double> relative_error() const;

 private:
  struct Sums {
    double mean = 0, variance = 0;
    uint64_t pixels = 0;
  };
  std::vector<Sums> bands_;
};

}  // namespace kiloband
