// How channels that cover a wavelength share it (DerivedChannels), exactly, for devices without double precision.
#pragma once

#include <vector>

#include "shared/spectra_layout.h"
#include "spectral/channels.hpp"

namespace kiloband::opencl {

struct ChannelCover {
  bool overlapping = false;          // else every divisor is 1 and the tables are empty
  std::vector<KbCover> cover;        // K + 1
  std::vector<KbCoverBreak> breaks;  // see KbCover
};

/// Divisors, 1 / share_k, are those of lambda_k = (1 - mu) min_k + mu max_k in double, for every float mu in [0, 1).
/// throws InputError  the breaks take more than max_bytes
ChannelCover make_channel_cover(const ChannelList& channels, std::size_t max_bytes);

}  // namespace kiloband::opencl
