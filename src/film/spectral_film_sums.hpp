// SpectralFilm's sums: what it holds of replicates that come in parts.
#pragma once

#include <atomic>

#include "film/spectral_film.hpp"

namespace kiloband {

inline constexpr uint32_t kTilesPerRow = kBlockSize / kTileSize;
inline constexpr uint32_t kTilesPerBlock = kTilesPerRow * kTilesPerRow;

/// Sums over the samples of a block in double.
struct SpectralFilm::Coarse {
  explicit Coarse(std::size_t channel_count)
      : channels(channel_count), sums(kTilesPerBlock * channel_count), counts(kTilesPerBlock) {}

  /// The means of `count` samples of a pixel of the block, times factor.
  void add(const PixelRect& block, std::size_t pixel, uint32_t count, std::span<const float> means,
           float factor);

  std::size_t channels;
  std::vector<double> sums;      // [tile][channel]
  std::vector<uint64_t> counts;  // [tile]
};

/// Blocks touch only their own elements: threads may work on different blocks.
struct SpectralFilm::Sums {
  static constexpr uint32_t kNone = ~0u;

  Sums(const PixelRect& rect, std::size_t blocks, const FilmOptions& options)
      : values({options.held ? options.replicates : 1, rect.pixels(), options.channels}, *options.sums,
               options.most_samples, options.memory_bytes),
        attempted(options.held ? options.replicates : 1, std::vector<uint32_t>(blocks)),
        open(options.held ? 0 : blocks, kNone) {}

  ReplicateSums values;
  std::vector<std::vector<uint32_t>> attempted;  // [slot][block]
  std::vector<uint32_t> open;                    // [block] of folded films: the replicate, or kNone
  std::vector<char> stale;                       // [block]: its sums are of before restart(); empty: none is
  std::function<void(uint32_t block)> observer;
  std::atomic<uint64_t> seal = 0;

  void break_seal() {
    if (seal.load(std::memory_order_relaxed) != 0) seal.store(0, std::memory_order_relaxed);
  }
};

}  // namespace kiloband
