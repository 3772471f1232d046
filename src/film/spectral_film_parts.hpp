// SpectralFilm's replicates that come in parts: the one that is open in every block.
#pragma once

#include "film/spectral_film.hpp"

namespace kiloband {

inline constexpr uint32_t kTilesPerRow = kBlockSize / kTileSize;
inline constexpr uint32_t kTilesPerBlock = kTilesPerRow * kTilesPerRow;

/// mean += share * (added - mean), rounded to float once; share is the added samples' part of all.
inline void combine(float* mean, const float* added, double share, std::size_t channels) {
  for (std::size_t c = 0; c < channels; ++c) {
    mean[c] = static_cast<float>(mean[c] + share * (static_cast<double>(added[c]) - mean[c]));
  }
}

/// Blocks touch only their own elements: threads may work on different blocks.
struct SpectralFilm::Parts {
  static constexpr uint32_t kNone = ~0u;

  Parts(std::size_t pixels, std::size_t blocks, std::size_t channels, bool tiles)
      : means(pixels * channels),
        counts(pixels),
        replicate(blocks, kNone),
        tile_sums(tiles ? blocks * kTilesPerBlock * channels : 0),
        tile_counts(tiles ? blocks * kTilesPerBlock : 0) {}

  std::vector<float> means;           // [pixel][channel], meaningful where counts > 0
  std::vector<uint64_t> counts;       // [pixel], samples
  std::vector<uint32_t> replicate;    // [block], kNone: nothing is open
  std::vector<double> tile_sums;      // [block][tile][channel], sums of samples
  std::vector<uint64_t> tile_counts;  // [block][tile]
};

}  // namespace kiloband
