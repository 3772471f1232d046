// The figures that say how far a render is from converged: RMS standard error over image mean, by band.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kiloband {

/// The relative error of a band is sqrt(mean over the pixels of the variance of their
/// mean) / |mean of the image|.
struct BandErrors {
  std::optional<double> worst;  // largest over the bands with light; none where no band has any
  std::size_t worst_band = 0;
  double median = 0;  // over the same bands; of an even number the upper one
  /// Bands whose mean is 0, which have no relative error. All bands are evaluated along the same paths, so a band
  /// that found no light where others did has none by the scene's data (no emission, or a reflectance of 0), and
  /// more samples would not change it.
  std::size_t dark_bands = 0;
};

/// Gathers means and variances of the mean of all pixels, band by band.
class ErrorSums {
 public:
  explicit ErrorSums(std::size_t bands) : means_(bands), variances_(bands), pixels_(bands) {}

  /// A pixel's values in all bands, in any unit. A variance of NaN (fewer than two replicates with a valid
  /// sample) leaves the pixel out of this band; one that is too large for a float, infinity,
  /// makes the band's error infinite.
  void add(std::span<const double> means, std::span<const double> variances);
  BandErrors errors() const;

 private:
  std::vector<double> means_, variances_;  // sums
  std::vector<uint64_t> pixels_;
};

}  // namespace kiloband
