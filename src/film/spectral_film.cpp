#include "film/spectral_film.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "film/scratch_memory.hpp"
#include "film/spectral_film_parts.hpp"

namespace kiloband {
namespace {

std::size_t tile_in_block(const PixelRect& block, std::size_t pixel) {
  const auto x = static_cast<uint32_t>(pixel % block.width);
  const auto y = static_cast<uint32_t>(pixel / block.width);
  return (y / kTileSize) * kTilesPerRow + x / kTileSize;
}

/// Sample counts of a pixel's replicates.
std::size_t held_count_bytes(const FilmOptions& options) {
  return sizeof(uint64_t) * options.replicates;
}

}  // namespace

std::vector<PixelRect> cut_into_blocks(const PixelRect& rect) {
  std::vector<PixelRect> blocks;
  const uint32_t x_end = rect.x0 + rect.width;
  const uint32_t y_end = rect.y0 + rect.height;
  for (uint32_t y = rect.y0; y < y_end; y = (y / kBlockSize + 1) * kBlockSize) {
    for (uint32_t x = rect.x0; x < x_end; x = (x / kBlockSize + 1) * kBlockSize) {
      const uint32_t x_next = std::min(x_end, (x / kBlockSize + 1) * kBlockSize);
      const uint32_t y_next = std::min(y_end, (y / kBlockSize + 1) * kBlockSize);
      blocks.push_back({x, y, x_next - x, y_next - y});
    }
  }
  return blocks;
}

/// Means of every replicate: [replicate][pixel][channel] and counts.
struct SpectralFilm::Held {
  ScratchFloats means;
  std::vector<std::vector<uint64_t>> samples;    // [replicate][pixel]
  std::vector<std::vector<uint32_t>> attempted;  // [replicate][block]
};

SpectralFilm::SpectralFilm(const PixelRect& rect, const FilmOptions& options)
    : rect_(rect), options_(options), blocks_(cut_into_blocks(rect)) {
  if (options.held) {
    const std::size_t counts = held_count_bytes(options) * rect.pixels();
    held_ = std::unique_ptr<Held>(
        new Held{ScratchFloats(std::size_t{options.replicates} * rect.pixels() * options.channels,
                               options.memory_bytes - std::min(options.memory_bytes, counts)),
                 std::vector(options.replicates, std::vector<uint64_t>(rect.pixels())),
                 std::vector(options.replicates, std::vector<uint32_t>(blocks_.size()))});
  } else {
    pixels_ = std::make_unique<ReplicateMoments>(rect.pixels(), options.channels, options.variance);
    if (options.variance) {
      tiles_ = std::make_unique<ReplicateMoments>(blocks_.size() * kTilesPerBlock, options.channels, true);
    }
    if (options.parts) {
      parts_ = std::make_unique<Parts>(rect.pixels(), blocks_.size(), options.channels, options.variance);
    }
  }
  block_sums_.resize(blocks_.size());
  block_counts_.assign(blocks_.size(), std::vector<uint64_t>(options.replicates));
}

SpectralFilm::~SpectralFilm() = default;
SpectralFilm::SpectralFilm(SpectralFilm&&) noexcept = default;

std::size_t SpectralFilm::bytes_per_pixel(const FilmOptions& options) {
  const std::size_t per_channel = options.held       ? sizeof(float) * options.replicates
                                  : options.variance ? 9
                                                     : sizeof(float);
  const std::size_t of_part = options.parts && !options.held ? sizeof(float) : 0;
  const std::size_t counts = options.held ? held_count_bytes(options) : 0;
  return options.channels * (per_channel + of_part) +
         options.channels * options.replicates * sizeof(double) / 1024 + counts + 32;
}

std::size_t SpectralFilm::pixel_index(const PixelRect& block, std::size_t pixel) const {
  const std::size_t x = block.x0 - rect_.x0 + pixel % block.width;
  const std::size_t y = block.y0 - rect_.y0 + pixel / block.width;
  return y * rect_.width + x;
}

void SpectralFilm::add(const BlockSamples& samples) {
  const PixelRect& block = blocks_.at(samples.block);
  if (samples.counts.size() != block.pixels() || samples.stride < options_.channels ||
      samples.replicate >= options_.replicates) {
    throw std::logic_error("SpectralFilm::add: samples do not have the block's shape");
  }
  if (held_) {
    add_held(samples, block);
  } else {
    parts_ ? add_part(samples, block) : add_folded(samples, block);
  }
  add_coarse(samples, block);
}

void SpectralFilm::add_folded(const BlockSamples& samples, const PixelRect& block) {
  for (std::size_t p = 0; p < block.pixels(); ++p) {
    pixels_->add(pixel_index(block, p), samples.counts[p],
                 samples.means.subspan(p * samples.stride, options_.channels));
  }
}

void SpectralFilm::add_held(const BlockSamples& samples, const PixelRect& block) {
  float* means = held_->means.values().data() + samples.replicate * rect_.pixels() * options_.channels;
  auto& counts = held_->samples[samples.replicate];
  held_->attempted[samples.replicate][samples.block] += samples.attempted;
  for (std::size_t p = 0; p < block.pixels(); ++p) {
    if (samples.counts[p] == 0) continue;
    const std::size_t pixel = pixel_index(block, p);
    counts[pixel] += samples.counts[p];
    const double share = static_cast<double>(samples.counts[p]) / static_cast<double>(counts[pixel]);
    float* mean = &means[pixel * options_.channels];
    const float* added = &samples.means[p * samples.stride];
    combine(mean, added, share, options_.channels);
  }
}

/// 8x8 tiles and the image: sums over the samples of the block in double.
void SpectralFilm::add_coarse(const BlockSamples& samples, const PixelRect& block) {
  const std::size_t channels = options_.channels;
  std::vector<double> tile_sums(kTilesPerBlock * channels);
  std::vector<uint64_t> tile_counts(kTilesPerBlock);
  for (std::size_t p = 0; p < block.pixels(); ++p) {
    const std::size_t tile = tile_in_block(block, p);
    const double count = samples.counts[p];
    const float* mean = &samples.means[p * samples.stride];
    double* sums = &tile_sums[tile * channels];
    for (std::size_t c = 0; c < channels; ++c) sums[c] += count * mean[c];
    tile_counts[tile] += samples.counts[p];
  }
  auto& block_sums = block_sums_[samples.block];
  if (block_sums.empty()) block_sums.resize(options_.replicates * channels);
  std::vector<float> tile_mean(channels);
  for (std::size_t tile = 0; tile < kTilesPerBlock; ++tile) {
    if (tile_counts[tile] == 0) continue;
    for (std::size_t c = 0; c < channels; ++c) {
      block_sums[samples.replicate * channels + c] += tile_sums[tile * channels + c];
      tile_mean[c] =
          static_cast<float>(tile_sums[tile * channels + c] / static_cast<double>(tile_counts[tile]));
    }
    block_counts_[samples.block][samples.replicate] += tile_counts[tile];
    if (tiles_ && parts_) {
      add_tile_part(samples, tile, {&tile_sums[tile * channels], channels}, tile_counts[tile]);
    } else if (tiles_) {
      tiles_->add(samples.block * kTilesPerBlock + tile, tile_counts[tile], tile_mean);
    }
  }
}

void SpectralFilm::row(uint32_t y, std::span<float> mean, std::span<float> variance) const {
  const std::size_t channels = options_.channels;
  std::unique_ptr<ReplicateMoments> folded;
  const ReplicateMoments* moments = pixels_.get();
  std::size_t first = std::size_t{y} * rect_.width;
  if (held_) {
    folded = std::make_unique<ReplicateMoments>(rect_.width, channels, !variance.empty());
    for (uint32_t r = 0; r < options_.replicates; ++r) {
      for (std::size_t x = 0; x < rect_.width; ++x) {
        folded->add(x, replicate_samples(r, first + x), replicate_mean(r, first + x));
      }
    }
    moments = folded.get();
    first = 0;
  }
  for (std::size_t x = 0; x < rect_.width; ++x) {
    std::ranges::copy(moments->mean(first + x), mean.begin() + static_cast<std::ptrdiff_t>(x * channels));
    if (!variance.empty()) moments->variance_of_mean(first + x, variance.subspan(x * channels, channels));
  }
}

uint64_t SpectralFilm::samples(uint32_t x, uint32_t y) const {
  const std::size_t pixel = std::size_t{y} * rect_.width + x;
  if (!held_) return pixels_->samples(pixel);
  uint64_t sum = 0;
  for (const auto& counts : held_->samples) sum += counts[pixel];
  return sum;
}

void SpectralFilm::require_held() const {
  if (!held_) throw std::logic_error("SpectralFilm: replicates are not held");
}

std::span<const float> SpectralFilm::replicate_mean(uint32_t replicate, std::size_t pixel) const {
  return held_means().subspan((replicate * rect_.pixels() + pixel) * options_.channels, options_.channels);
}

uint64_t SpectralFilm::replicate_samples(uint32_t replicate, std::size_t pixel) const {
  require_held();
  return held_->samples.at(replicate)[pixel];
}

uint32_t SpectralFilm::attempted(uint32_t replicate, uint32_t block) const {
  require_held();
  return held_->attempted.at(replicate).at(block);
}

std::span<float> SpectralFilm::held_means() {
  require_held();
  return held_->means.values();
}

std::span<const float> SpectralFilm::held_means() const {
  require_held();
  return std::as_const(held_->means).values();
}

HeldCountsView SpectralFilm::held_counts() const {
  require_held();
  return {held_->samples, held_->attempted, block_sums_, block_counts_};
}

void SpectralFilm::restore(HeldCounts counts) {
  require_held();
  if (counts.samples.size() != options_.replicates || counts.attempted.size() != options_.replicates ||
      counts.block_sums.size() != blocks_.size() || counts.block_samples.size() != blocks_.size()) {
    throw std::logic_error("SpectralFilm::restore: counts do not have the film's shape");
  }
  held_->samples = std::move(counts.samples);
  held_->attempted = std::move(counts.attempted);
  block_sums_ = std::move(counts.block_sums);
  block_counts_ = std::move(counts.block_samples);
}

const ReplicateMoments& SpectralFilm::tile_moments() const {
  if (!tiles_) throw std::logic_error("SpectralFilm: tile moments are kept by folded films with variance");
  return *tiles_;
}

void SpectralFilm::add_image_sums(std::vector<std::vector<double>>& sums,
                                  std::vector<uint64_t>& counts) const {
  sums.resize(options_.replicates, std::vector<double>(options_.channels));
  counts.resize(options_.replicates);
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    if (block_sums_[block].empty()) continue;
    for (uint32_t r = 0; r < options_.replicates; ++r) {
      const double* from = &block_sums_[block][r * options_.channels];
      for (std::size_t c = 0; c < options_.channels; ++c) sums[r][c] += from[c];
      counts[r] += block_counts_[block][r];
    }
  }
}

ReplicateMoments SpectralFilm::image_moments() const {
  std::vector<std::vector<double>> sums;
  std::vector<uint64_t> counts;
  add_image_sums(sums, counts);
  return moments_of_sums(sums, counts);
}

ReplicateMoments moments_of_sums(const std::vector<std::vector<double>>& sums,
                                 const std::vector<uint64_t>& counts) {
  const std::size_t channels = sums.empty() ? 0 : sums.front().size();
  ReplicateMoments moments(1, channels, true);
  std::vector<float> mean(channels);
  for (std::size_t r = 0; r < sums.size(); ++r) {
    if (counts[r] == 0) continue;
    for (std::size_t c = 0; c < channels; ++c)
      mean[c] = static_cast<float>(sums[r][c] / static_cast<double>(counts[r]));
    moments.add(0, counts[r], mean);
  }
  return moments;
}

}  // namespace kiloband
