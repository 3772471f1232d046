// Comparison of images of which only means and their variances are known: the means alone can be tested.
//
// Nothing says how pixels and channels depend on each other. Channels: the Bonferroni bound. Pixels: where
// they share random numbers (wavelength offsets, filters wider than a pixel) the variance of a tile is not
// the sum of its pixels'; tiles and the image are tested only if the caller knows
// that pixels are independent.
#pragma once

#include "stats/comparison/comparison.hpp"
#include "stats/comparison/sides.hpp"

namespace kiloband::stats {

/// dof: of the variances; infinite where unknown (normal). A variance that is negative or not finite is none.
/// In double: of means below 1e-19 or above 1e19 floats do not hold the squares.
struct MomentImage {
  uint32_t width = 0, height = 0;
  std::size_t channels = 0;
  double dof = 0;
  std::vector<float> mean;             // [pixel][channel]
  std::vector<double> variance;        // [pixel][channel], of the mean
  std::vector<double> pixel_dof = {};  // [pixel] instead of dof; may be empty

  double dof_of(std::size_t pixel) const { return pixel_dof.empty() ? dof : pixel_dof[pixel]; }
};

/// The moments of replicates; one less than have samples in the pixel are its degrees of freedom. The
/// variance is NaN with fewer than two, the mean without any;
/// the mean is infinite where a replicate is not finite.
MomentImage moments_of(const ReplicateImage& image);

/// Strips as in StripComparison. A pixel whose mean is NaN in all channels on both sides is left out;
/// any other mean that is not finite is a difference. A channel without a variance on a side is left out of
/// its pixel, and the pixel out of the channel's tile and image.
class MomentComparison {
 public:
  MomentComparison(uint32_t width, uint32_t height, std::size_t channels, bool independent_pixels,
                   const ComparisonOptions& options);
  void add(const MomentImage& a, const MomentImage& b);
  Comparison finish();

 private:
  /// Sums over the pixels of a unit.
  struct Sums {
    std::vector<double> pixels, a, b, variance, spread;  // [channel]; spread: sum of v^2 / dof
  };
  AgreeingArea area_of(const MomentImage& a, const MomentImage& b, const UnitPlace& place) const;
  void add_pixel(const MomentImage& a, const MomentImage& b, uint32_t x, uint32_t y,
                 const AgreeingArea& area);
  Contrast pixel_contrast(const MomentImage& a, const MomentImage& b, std::size_t pixel,
                          std::vector<bool>& wanted) const;
  void add_sums(Sums& sums, const Contrast& pixel, const std::vector<bool>& wanted) const;
  Contrast contrast_of(const Sums& sums) const;
  void add_unit(ScaleTest& scale, std::ptrdiff_t index, const UnitPlace& place, const Sums& sums,
                const AgreeingArea& area) const;

  uint32_t width_, height_, next_row_ = 0;
  double chance_ = 0;  // chance_agreement of the sides
  std::size_t channels_, non_finite_ = 0;
  bool independent_;
  ComparisonOptions options_;
  ScaleTest pixels_, tiles_, whole_;
  Sums tile_, image_;
  AgreeingArea image_area_;
};

}  // namespace kiloband::stats
