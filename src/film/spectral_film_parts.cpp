#include "film/spectral_film_parts.hpp"

#include <algorithm>

namespace kiloband {

/// The open replicate of the block goes on, or is folded and the next one opened.
void SpectralFilm::add_part(const BlockSamples& samples, const PixelRect& block) {
  uint32_t& open = parts_->replicate[samples.block];
  if (open != samples.replicate) fold_block(samples.block);
  open = samples.replicate;
  for (std::size_t p = 0; p < block.pixels(); ++p) {
    if (samples.counts[p] == 0) continue;
    const std::size_t pixel = pixel_index(block, p);
    uint64_t& count = parts_->counts[pixel];
    count += samples.counts[p];
    const double share = static_cast<double>(samples.counts[p]) / static_cast<double>(count);
    combine(&parts_->means[pixel * options_.channels], &samples.means[p * samples.stride], share,
            options_.channels);
  }
}

/// Comes after add_part(): the block's open replicate is that of the samples.
void SpectralFilm::add_tile_part(const BlockSamples& samples, std::size_t tile, std::span<const double> sums,
                                 uint64_t count) {
  const std::size_t unit = samples.block * kTilesPerBlock + tile;
  double* const to = &parts_->tile_sums[unit * options_.channels];
  for (std::size_t c = 0; c < sums.size(); ++c) to[c] += sums[c];
  parts_->tile_counts[unit] += count;
}

/// Moves the open replicate of a block into the moments; nothing is open then.
void SpectralFilm::fold_block(uint32_t block) {
  if (parts_->replicate[block] == Parts::kNone) return;
  parts_->replicate[block] = Parts::kNone;
  const std::size_t channels = options_.channels;
  for (std::size_t p = 0; p < blocks_[block].pixels(); ++p) {
    const std::size_t pixel = pixel_index(blocks_[block], p);
    pixels_->add(pixel, parts_->counts[pixel], {&parts_->means[pixel * channels], channels});
    parts_->counts[pixel] = 0;  // the next samples have share 1: the old mean is forgotten
  }
  if (!tiles_) return;
  std::vector<float> mean(channels);
  for (std::size_t unit = block * kTilesPerBlock; unit < (block + 1) * kTilesPerBlock; ++unit) {
    const uint64_t count = parts_->tile_counts[unit];
    if (count == 0) continue;
    double* const sums = &parts_->tile_sums[unit * channels];
    for (std::size_t c = 0; c < channels; ++c)
      mean[c] = static_cast<float>(sums[c] / static_cast<double>(count));
    tiles_->add(unit, count, mean);
    std::fill_n(sums, channels, 0.0);
    parts_->tile_counts[unit] = 0;
  }
}

void SpectralFilm::finish_replicates() {
  if (!parts_) return;
  for (uint32_t block = 0; block < blocks_.size(); ++block) fold_block(block);
}

}  // namespace kiloband
