// Sums of the samples of replicates, with which a render can go on at any time.
//
// The samples x_0, x_1 ... of a pixel's replicate are added in their order, in chunks whose bounds depend on
// the scene and the backend alone (SumRule). The OPEN sum is the float sum of the chunk that was begun last,
// sample after sample from 0 on; the CLOSED sum is what all chunks before it add up to. A full chunk stays
// open until the next sample comes. Both are thus functions of the samples, not of the deliveries that they
// came in: a render that was interrupted goes on with the bits that it would have had.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "files/scratch_memory.hpp"

namespace kiloband {

/// How a backend adds samples.
struct SumRule {
  enum class Kind : uint32_t {
    kFolded,      // the closed sum is a double; mean = float((closed + open) / n)
    kCompensated  // it is a float and its rounding errors, CompensatedSum (Knuth, TAOCP 2, 4.2.2)
  };
  Kind kind = Kind::kFolded;
  uint32_t chunk = 64;   // most samples of a chunk; 0: every sample is closed at once
  uint32_t period = 64;  // bounds of chunks are the multiples of this, and those of `chunk` from each on
  /// Deliveries should end at multiples of this, or where the replicate ends; 1: anywhere.
  uint32_t step = 1;

  bool operator==(const SumRule&) const = default;
};

struct CompensatedSum {
  float sum = 0, lost = 0;
};

/// A double (kFolded) or a CompensatedSum: std::bit_cast tells.
using ClosedSum = uint64_t;

/// The sums of one pixel in one replicate.
struct PixelSums {
  uint32_t& count;              // valid samples
  std::span<float> open;        // [channel]
  std::span<ClosedSum> closed;  // [channel]; empty in a film that needs none
};
struct PixelSumsView {
  uint32_t count;
  std::span<const float> open;
  std::span<const ClosedSum> closed;
};

/// Open sums of pixels that follow each other.
struct OpenSums {
  std::span<uint32_t> counts;  // [pixel]
  std::span<float> values;     // [pixel][channel]
};
struct OpenSumsView {
  std::span<const uint32_t> counts;
  std::span<const float> values;
};

/// mean[channel] of `attempted` samples of which sums.count are valid; 0 where there are none.
void mean_of_sums(const SumRule& rule, uint32_t attempted, const PixelSumsView& sums, std::span<float> mean);

/// [slot][pixel][channel]; a slot holds a replicate. 4 bytes per value, and 8 more for closed sums where a
/// replicate may have more samples than a chunk.
class ReplicateSums {
 public:
  struct Shape {
    std::size_t slots = 1, pixels = 0, channels = 0;
  };

  /// All sums are 0. Arrays beyond memory_bytes live in scratch files.
  /// throws DeviceError  no memory, no space
  ReplicateSums(const Shape& shape, const SumRule& rule, uint32_t most_samples, std::size_t memory_bytes);

  PixelSums at(std::size_t slot, std::size_t pixel);
  PixelSumsView at(std::size_t slot, std::size_t pixel) const;
  OpenSums open(std::size_t slot, std::size_t pixel, std::size_t pixels);
  OpenSumsView open(std::size_t slot, std::size_t pixel, std::size_t pixels) const;
  const SumRule& rule() const { return rule_; }
  /// No pixel has a sample; what its sums hold is for the caller to clear.
  void forget_counts() { counts_.assign(counts_.size(), 0); }

  /// Bytes per value with its part of nothing else.
  static std::size_t bytes_per_value(const SumRule& rule, uint32_t most_samples);

 private:
  Shape shape_;
  SumRule rule_;
  ScratchFloats open_, closed_;
  std::vector<uint32_t> counts_;
};

}  // namespace kiloband
