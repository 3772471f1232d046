// Two images, or an image and the truth: all tests at all scales, with one level for the whole.
//
//     const Comparison result = compare_independent(cpu, opencl, {.alpha = 1e-4});
//     if (!result.passed) ... result.tests says which test failed, where, and by how much
//
// Tests: means of pixels, 8x8 tiles and the image; variances of pixels, tiles and pooled over the image;
// uniformity of the p-values of pixels and tiles where there are 1000 of them and both sides are the same
// estimator. Each gets an equal share of alpha; a comparison passes if every one does. Nothing is forgiven:
// no share of pixels may differ.
//
// Pixels need kPixelReplicates: across an edge noise is discrete, so that fewer agree by chance, nearly or
// quite, in one of thousands of pixels (contrast.hpp). What t would have to be there with 4 replicates,
// above 1000, only such a pixel reaches. Tiles and the image, sums of many pixels, are tested.
// What is needed: replicates that are independent of each other; independent sides (other seeds), or pairs of
// equal seed for compare_paired. 32 replicates are wanted; fewer work, with wider tails, and are noted.
// Against a truth pixels and tiles only speak where noise is not too skewed: a pixel whose rare bright path
// was not met is not its mean, and nothing in it says so (two independent sides both lack it or scatter
// alike). They are left out, with a note, where the image's noise has a kurtosis (count /
// TailWeight::effective) above kTruthKurtosis, in a tile 64 times less of the excess: without that 98 % false
// alarms instead of 1 % for lognormal noise.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "stats/scale_test.hpp"
#include "stats/tails.hpp"
#include "stats/uniformity.hpp"
#include "stats/variance_test.hpp"

namespace kiloband::stats {

struct ComparisonOptions {
  double alpha = 1e-3;      // of the whole comparison
  double rounding = 1e-5;   // of a mean: differences that float arithmetic may make
  uint64_t seed = 1;        // of rotations and divisions
  bool variances = true;    // false: the sides are different estimators
  bool fine_scales = true;  // false: the image alone
};

inline constexpr double kTruthKurtosis = 6.5;

/// On a side, for the means of pixels.
inline constexpr uint32_t kPixelReplicates = 8;

enum class Kind { kIndependent, kPaired, kTruth };

/// Values per channel or per pixel and channel; how far off they may be themselves (may be empty).
struct Truth {
  std::vector<double> value, bound;
  bool per_pixel = false;
};

/// One test's part in the verdict.
struct TestVerdict {
  std::string name;  // "mean/pixel", "mean/tile", "mean/image", "variance/pixel", "variance/tile",
                     // "scatter/image", "variance/image", "uniform/pixel", "uniform/tile", "finite"
  double p = 1, level = 0;
  bool passed = true;
  Detectable detectable;  // of means: relative bias; of variances over the image: relative change; else NaN
  std::optional<WorstUnit> worst;  // of tests over units
};

struct Comparison {
  Kind kind = Kind::kIndependent;
  double alpha = 0;
  bool passed = true;
  uint32_t width = 0, height = 0;
  uint32_t replicates_a = 0, replicates_b = 0;  // 0: a truth, or variances alone
  std::size_t channels = 0;
  std::vector<TestVerdict> tests;      // those that had something to test
  std::vector<Scale> scales;           // of `means`
  std::vector<ScaleResult> means;      // pixel, tile, image; the image alone without fine scales
  std::vector<ScaleResult> variances;  // pixel, tile; may be empty
  std::optional<PooledVariance> pooled_scatter, pooled_variance;
  std::optional<UniformityResult> uniform_pixels, uniform_tiles;
  std::vector<TailWeight> tails_a, tails_b;           // [channel]; b empty for a truth
  std::vector<double> image_a, image_b, image_error;  // [channel] means and the difference's standard error
  // Replicate means of pixels that are NaN or infinite, pixels with such a truth; from moments alone: pixels
  // with such a value, or with values on one side alone.
  std::size_t non_finite = 0;
  std::vector<std::string> notes;  // what the reader must know to judge a pass

  /// The failed test with the smallest p, or the smallest p if all passed.
  const TestVerdict& decisive() const;
};

/// throws std::logic_error  the images differ in shape, or break check_shape()
///        InputError        no pixel has two replicates with samples on both sides, and nothing is not finite
Comparison compare_independent(const ReplicateImage& a, const ReplicateImage& b,
                               const ComparisonOptions& options);
/// Equal seeds: replicate r of A belongs to replicate r of B. Means alone.
Comparison compare_paired(const ReplicateImage& a, const ReplicateImage& b, const ComparisonOptions& options);
/// throws std::logic_error  the truth has not the image's channels (and pixels)
Comparison compare_truth(const ReplicateImage& a, const Truth& truth, const ComparisonOptions& options);

/// The same for images that come in strips from top to bottom,
/// each a multiple of kTileEdge rows but the last.
class StripComparison {
 public:
  /// replicates_b: ignored for a truth.
  StripComparison(Kind kind, uint32_t width, uint32_t height, std::size_t channels, uint32_t replicates_a,
                  uint32_t replicates_b, const ComparisonOptions& options);
  ~StripComparison();
  void add(const ReplicateImage& a, const ReplicateImage& b);
  /// truth.per_pixel: of the strip's pixels
  void add(const ReplicateImage& a, const Truth& truth);
  Comparison finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kiloband::stats
