// Where spectra of colours are interpolated: cells of wavelengths, and the channels in them.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spectral/channels.hpp"
#include "src_cpu/evaluate/evaluator_kernels.hpp"

namespace kiloband::cpu {

/// The cells of a channel list at wavelengths. The cell of a channel and its place in it depend on that channel alone, and so do
/// the bits of what is interpolated.
class ColourCellRows {
 public:
  /// padded: channels of a row.
  ColourCellRows(const ChannelList& channels, std::size_t padded);

  /// offsets_nm: of the padded channels, clamped to where colours are defined, from KB_TEXTURE_CENTRE_NM.
  /// Returns null where no channel is narrow. Valid until the next call.
  const ColourCells* place(const float* offsets_nm);

 private:
  std::vector<bool> narrow_;  // of padded channels
  hwy::AlignedFreeUniquePtr<float[]> nodes_, centres_, places_;
  hwy::AlignedFreeUniquePtr<int32_t[]> cells_of_;
  ColourCells cells_;
};

}  // namespace kiloband::cpu
