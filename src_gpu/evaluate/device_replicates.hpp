// What the replicates of a film have come to, on the device: means and squares are gathered there, and come to the host once
// (kernels/film/replicates.cl).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "src_gpu/evaluate/device_film.hpp"

namespace kiloband::opencl {

/// Replicates of the pixels of whole blocks, one block behind the other: all but their means and squares.
struct FoldedReplicates {
  uint32_t number = 0;                        // of replicates
  std::vector<uint64_t> samples;              // [pixel]
  std::vector<uint32_t> replicates;           // [pixel], those with samples
  std::vector<std::vector<double>> sums;      // [block][replicate * (K + D) + value]: of the block's samples
  std::vector<std::vector<uint64_t>> counts;  // [block][replicate]
};

class DeviceReplicates {
 public:
  /// Valid samples that a pixel's replicate has at most: exact as floats.
  static constexpr uint64_t kMostSamples = 1u << 24;

  static uint64_t bytes_per_pixel(const KbSpectraLayout& layout, bool variance);

  /// Of `pixels` pixels of the film, whose layout device_layout is; all of them must outlive the object.
  /// throws DeviceOutOfMemory
  DeviceReplicates(DeviceContext& context, DeviceMemory& memory, const KbSpectraLayout& layout,
                   const DeviceBuffer<KbSpectraLayout>& device_layout, DeviceFilm& film, bool variance,
                   bool program_cache, uint64_t pixels);

  /// No replicates of blocks with so many pixels, which stand in the film one behind the other from its first pixel on.
  void begin(std::span<const std::size_t> block_pixels);
  /// The film has all samples of the next replicate, none of them in an open chunk: they become part of the moments, and it has none.
  void fold();
  /// What was folded.
  const FoldedReplicates& folded() const { return folded_; }
  /// Means and squares of some pixels, [pixel][K + D]; m2 is left alone where there are none.
  void bring(const DeviceFilm::Pixels& pixels, std::vector<float>& mean, std::vector<float>& m2);

 private:
  uint32_t pixels_of_part() const;
  void weigh();
  void launch();
  void add_sums();

  DeviceMemory& memory_;
  KbSpectraLayout layout_;
  const DeviceBuffer<KbSpectraLayout>& device_layout_;
  DeviceFilm& film_;
  bool variance_, on_cpu_;
  uint32_t width_;  // channels of a work-item
  DeviceBuffer<float> mean_, m2_, sums_, lost_;
  DeviceBuffer<KbFloat2> weights_;
  DeviceBuffer<KbFilmPart> device_parts_;
  Program program_;
  ReplicatesKernel fold_;
  std::vector<KbFilmPart> parts_;
  std::vector<uint32_t> block_of_part_;
  std::vector<uint32_t> counts_;  // of the replicate that is folded
  std::vector<KbFloat2> host_weights_;
  FoldedReplicates folded_;
};

}  // namespace kiloband::opencl
