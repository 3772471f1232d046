// Both sides of a unit, whatever the second one is: replicates, or a truth with its bound.
#pragma once

#include "stats/comparison/comparison.hpp"

namespace kiloband::stats {

struct Sides {
  UnitSample a, b;   // b: one replicate of A's weight for a truth
  UnitSample bound;  // of a truth; no replicates otherwise
};

/// Joins units of both sides (Pool).
class SidesPool {
 public:
  SidesPool(Kind kind, std::size_t channels, uint32_t replicates_a, uint32_t replicates_b);
  void add(const Sides& unit);
  void add_marked(const Sides& unit, const std::vector<bool>& channels);
  Sides mean() const;
  void clear();

 private:
  Pool a_, b_, bound_;
};

/// Pixels of a pair of images, or of an image and a truth.
class PixelSource {
 public:
  PixelSource(const ReplicateImage& a, const ReplicateImage* b, const Truth* truth)
      : a_(a), b_(b), truth_(truth) {}
  /// Returns how many replicates lost samples (gather_pixel). A truth that is not finite takes away all of
  /// A's, and counts once; where A has none it does not matter.
  std::size_t gather(std::size_t pixel, Sides& out) const;
  const ReplicateImage& image() const { return a_; }

 private:
  const ReplicateImage& a_;
  const ReplicateImage* b_;
  const Truth* truth_;
};

Contrast contrast_of(Kind kind, const Sides& sides, double rounding);

/// Pixels of a unit whose replicates agree on both sides, on different values. An edge, whose replicates
/// agree by chance, crosses a quarter of a tile's pixels: where more than half of a unit differ so, there
/// is no noise, and a difference is one (Contrast::agreement).
class AgreeingArea {
 public:
  explicit AgreeingArea(std::size_t channels) : different_(channels) {}
  /// A pixel; of one that is not valid nothing is known.
  void add(const Contrast& pixel);
  void add(const AgreeingArea& part);
  /// Of the unit, or of one of its pixels.
  void settle(Contrast& contrast) const;
  void clear();

 private:
  std::size_t pixels_ = 0;
  std::vector<std::size_t> different_;  // [channel]
};

/// Channels with enough contributions to be tested, or none on any side (equal). thin: how many have too few.
std::vector<bool> testable_channels(Kind kind, const Sides& sides, std::size_t& thin);

}  // namespace kiloband::stats
