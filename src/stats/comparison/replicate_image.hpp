// An image as the statistical tests see it: the means of independently randomised replicates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kiloband::stats {

/// A replicate without samples in a pixel has samples 0 there; its means are not looked at.
struct ReplicateImage {
  uint32_t width = 0, height = 0;
  std::size_t channels = 0;
  uint32_t replicates = 0;
  std::vector<float> means;       // [replicate][pixel][channel]
  std::vector<uint64_t> samples;  // [replicate][pixel]

  std::size_t pixels() const { return std::size_t{width} * height; }
  float at(uint32_t replicate, std::size_t pixel, std::size_t channel) const {
    return means[(replicate * pixels() + pixel) * channels + channel];
  }
  uint64_t samples_at(uint32_t replicate, std::size_t pixel) const {
    return samples[replicate * pixels() + pixel];
  }
};

/// throws std::logic_error  the arrays have not the lengths that the numbers say
void check_shape(const ReplicateImage& image);

/// A unit is what one test is about: a pixel, a tile of 8x8 pixels, the image. Each scale sees biases that
/// the others miss: a few wrong pixels, a region, a small error everywhere.
enum class Scale { kPixel, kTile, kImage };
inline constexpr uint32_t kTileEdge = 8;
inline uint32_t tiles_along(uint32_t pixels) {
  return (pixels + kTileEdge - 1) / kTileEdge;
}
const char* name_of(Scale scale);

/// One side of a unit: its replicate means.
struct UnitSample {
  std::size_t channels = 0;
  std::vector<double> means;    // [replicate][channel]
  std::vector<double> weights;  // [replicate], number of samples; 0: the replicate has none here

  std::size_t replicates() const { return weights.size(); }
  double mean_at(std::size_t replicate, std::size_t channel) const {
    return means[replicate * channels + channel];
  }
  /// Replicates that have samples.
  std::size_t sampled() const;
};

/// The replicates of a pixel. A mean that is not finite takes its replicate's samples away; returns how many
/// replicates lost theirs.
std::size_t gather_pixel(const ReplicateImage& image, std::size_t pixel, UnitSample& out);

/// Joins units into a larger one: each replicate's mean over all of the units' samples, in double.
class Pool {
 public:
  Pool(std::size_t replicates, std::size_t channels);

  void add(const UnitSample& unit);
  /// Channels without a mark count as zero, so that what was marked is tested for itself.
  void add_marked(const UnitSample& unit, const std::vector<bool>& channels);
  UnitSample mean() const;
  void clear();

 private:
  std::size_t channels_;
  std::vector<double> sums_, weights_;  // as in UnitSample, times weights
};

}  // namespace kiloband::stats
