#include "film/spectral_film.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "files/scratch_memory.hpp"
#include "film/moment_kernels.hpp"
#include "film/spectral_film_sums.hpp"

namespace kiloband {
namespace {

std::size_t tile_in_block(const PixelRect& block, std::size_t pixel) {
  const auto x = static_cast<uint32_t>(pixel % block.width);
  const auto y = static_cast<uint32_t>(pixel / block.width);
  return (y / kTileSize) * kTilesPerRow + x / kTileSize;
}

/// Sample counts of a pixel's replicates.
std::size_t count_bytes(const FilmOptions& options) {
  if (options.sums) return sizeof(uint32_t) * (options.held ? options.replicates : 1);
  return options.held ? sizeof(uint64_t) * options.replicates : 0;
}

/// Of a value: what is held of it, or its moments.
std::size_t value_bytes(const FilmOptions& options) {
  const std::size_t moments = options.variance ? 9 : sizeof(float);
  if (!options.sums) return options.held ? sizeof(float) * options.replicates : moments;
  const std::size_t sums = ReplicateSums::bytes_per_value(*options.sums, options.most_samples);
  return options.held ? sums * options.replicates : moments + sums;
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
  std::vector<std::vector<uint64_t>> samples;  // [replicate][pixel]
};

SpectralFilm::SpectralFilm(const PixelRect& rect, const FilmOptions& options)
    : rect_(rect), options_(options), blocks_(cut_into_blocks(rect)) {
  if (options.sums) sums_ = std::make_unique<Sums>(rect, blocks_.size(), options);
  if (options.held && !options.sums) {
    const std::size_t counts = count_bytes(options) * rect.pixels();
    held_ = std::unique_ptr<Held>(
        new Held{ScratchFloats(std::size_t{options.replicates} * rect.pixels() * options.channels,
                               options.memory_bytes - std::min(options.memory_bytes, counts)),
                 std::vector(options.replicates, std::vector<uint64_t>(rect.pixels()))});
  }
  if (!options.held)
    pixels_ = std::make_unique<ReplicateMoments>(rect.pixels(), options.channels, options.variance);
  block_sums_.resize(blocks_.size());
  block_counts_.assign(blocks_.size(), std::vector<uint64_t>(options.replicates));
  if (!sums_) added_.assign(blocks_.size(), std::vector<char>(options.replicates));
}

SpectralFilm::~SpectralFilm() = default;
SpectralFilm::SpectralFilm(SpectralFilm&&) noexcept = default;

std::vector<uint32_t> SpectralFilm::all_blocks() const {
  std::vector<uint32_t> blocks(blocks_.size());
  std::iota(blocks.begin(), blocks.end(), 0u);
  return blocks;
}

std::size_t SpectralFilm::bytes_per_pixel(const FilmOptions& options) {
  return options.channels * value_bytes(options) +
         options.channels * options.replicates * sizeof(double) / 1024 + count_bytes(options) + 32;
}

std::size_t SpectralFilm::pixel_index(const PixelRect& block, std::size_t pixel) const {
  const std::size_t x = block.x0 - rect_.x0 + pixel % block.width;
  const std::size_t y = block.y0 - rect_.y0 + pixel / block.width;
  return y * rect_.width + x;
}

void SpectralFilm::add(const BlockSamples& samples) {
  const PixelRect& block = blocks_.at(samples.block);
  if (samples.counts.size() != block.pixels() || samples.stride < options_.channels ||
      (!samples.factors.empty() && samples.factors.size() != block.pixels()) ||
      samples.replicate >= options_.replicates) {
    throw std::logic_error("SpectralFilm::add: samples do not have the block's shape");
  }
  if (sums_) throw std::logic_error("SpectralFilm::add: the film keeps sums");
  add_pixels(samples);
  added_[samples.block][samples.replicate] = 1;
}

void SpectralFilm::set(const BlockMoments& moments) {
  const PixelRect& block = blocks_.at(moments.block);
  const std::size_t channels = options_.channels, values = block.pixels() * channels;
  if (!pixels_) throw std::logic_error("SpectralFilm::set: replicates are held");
  if (moments.samples.size() != block.pixels() || moments.replicates.size() != block.pixels() ||
      moments.mean.size() != values || moments.m2.size() != (options_.variance ? values : 0) ||
      moments.counts.size() > options_.replicates || moments.sums.size() != moments.counts.size() * channels)
    throw std::logic_error("SpectralFilm::set: moments do not have the block's shape");
  if (sums_) forget_open(moments.block);
  for (std::size_t p = 0; p < block.pixels(); ++p) {
    const auto of_pixel = [&](std::span<const float> all) {
      return all.empty() ? all : all.subspan(p * channels, channels);
    };
    pixels_->set(pixel_index(block, p), moments.samples[p], moments.replicates[p], of_pixel(moments.mean),
                 of_pixel(moments.m2));
  }
  set_coarse(moments);
}

bool SpectralFilm::has(uint32_t replicate, uint32_t block) const {
  if (sums_) throw std::logic_error("SpectralFilm::has: the film keeps sums");
  return added_.at(block).at(replicate) != 0;
}

/// Each pixel's means are read once: while they are in the first cache, all that is made of them is.
void SpectralFilm::add_pixels(const BlockSamples& samples) {
  const PixelRect& block = blocks_[samples.block];
  Coarse coarse(options_.channels);
  for (std::size_t p = 0; p < block.pixels(); ++p) {
    const auto means = samples.means.subspan(p * samples.stride, options_.channels);
    if (pixels_)
      pixels_->add(pixel_index(block, p), samples.counts[p], means, samples.factor(p));
    else
      add_held(samples, p);
    coarse.add(block, p, samples.counts[p], means, samples.factor(p));
  }
  add_coarse(samples.replicate, samples.block, coarse);
}

void SpectralFilm::add_held(const BlockSamples& samples, std::size_t pixel_in_block) {
  if (samples.counts[pixel_in_block] == 0) return;
  const std::size_t pixel = pixel_index(blocks_[samples.block], pixel_in_block);
  uint64_t& count = held_->samples[samples.replicate][pixel];
  if (count > 0) throw std::logic_error("SpectralFilm::add: a replicate of a block comes twice");
  count = samples.counts[pixel_in_block];
  float* const means =
      &held_->means.values()[(samples.replicate * rect_.pixels() + pixel) * options_.channels];
  film::set_mean(
      {options_.channels, &samples.means[pixel_in_block * samples.stride], samples.factor(pixel_in_block)},
      means);
}

void SpectralFilm::Coarse::add(const PixelRect& block, std::size_t pixel, uint32_t count,
                               std::span<const float> means, float factor) {
  const std::size_t tile = tile_in_block(block, pixel);
  film::add_samples({channels, means.data(), factor}, count, &sums[tile * channels]);
  counts[tile] += count;
}

/// The block's share of the image, tile by tile: few numbers to a sum keep its rounding small.
void SpectralFilm::add_coarse(uint32_t replicate, uint32_t block, const Coarse& coarse) {
  const std::size_t channels = options_.channels;
  auto& block_sums = block_sums_[block];
  if (block_sums.empty()) block_sums.resize(options_.replicates * channels);
  for (std::size_t tile = 0; tile < kTilesPerBlock; ++tile) {
    const uint64_t count = coarse.counts[tile];
    if (count == 0) continue;
    const double* const sums = &coarse.sums[tile * channels];
    for (std::size_t c = 0; c < channels; ++c) block_sums[replicate * channels + c] += sums[c];
    block_counts_[block][replicate] += count;
  }
}

void SpectralFilm::set_coarse(const BlockMoments& moments) {
  auto& sums = block_sums_[moments.block];
  auto& counts = block_counts_[moments.block];
  sums.assign(options_.replicates * options_.channels, 0.0);
  std::ranges::copy(moments.sums, sums.begin());
  std::ranges::fill(counts, 0);
  std::ranges::copy(moments.counts, counts.begin());
  if (sums_) return;
  std::ranges::fill(added_[moments.block], char{0});
  std::fill_n(added_[moments.block].begin(), moments.counts.size(), char{1});
}

void SpectralFilm::row(uint32_t y, std::span<float> mean, std::span<float> variance) const {
  const std::size_t channels = options_.channels;
  std::unique_ptr<ReplicateMoments> folded;
  const ReplicateMoments* moments = pixels_.get();
  std::size_t first = std::size_t{y} * rect_.width;
  if (options_.held) {
    folded = std::make_unique<ReplicateMoments>(rect_.width, channels, !variance.empty());
    std::vector<float> one(channels);
    for (uint32_t r = 0; r < options_.replicates; ++r) {
      for (std::size_t x = 0; x < rect_.width; ++x) {
        replicate_mean(r, first + x, one);
        folded->add(x, replicate_samples(r, first + x), one);
      }
    }
    moments = folded.get();
    first = 0;
  }
  for (std::size_t x = 0; x < rect_.width; ++x) {
    const auto to = mean.subspan(x * channels, channels);
    if (moments->samples(first + x) == 0)
      std::ranges::fill(to, 0.0f);
    else
      std::ranges::copy(moments->mean(first + x), to.begin());
    if (!variance.empty()) moments->variance_of_mean(first + x, variance.subspan(x * channels, channels));
  }
}

uint64_t SpectralFilm::samples(uint32_t x, uint32_t y) const {
  const std::size_t pixel = std::size_t{y} * rect_.width + x;
  if (pixels_) return pixels_->samples(pixel);
  uint64_t sum = 0;
  for (uint32_t r = 0; r < options_.replicates; ++r) sum += replicate_samples(r, pixel);
  return sum;
}

uint32_t SpectralFilm::replicates(uint32_t x, uint32_t y) const {
  const std::size_t pixel = std::size_t{y} * rect_.width + x;
  if (pixels_) return pixels_->replicates(pixel);
  uint32_t count = 0;
  for (uint32_t r = 0; r < options_.replicates; ++r) count += replicate_samples(r, pixel) > 0;
  return count;
}

void SpectralFilm::require_held() const {
  if (!options_.held) throw std::logic_error("SpectralFilm: replicates are not held");
}

void SpectralFilm::replicate_mean(uint32_t replicate, std::size_t pixel, std::span<float> mean) const {
  require_held();
  if (sums_)
    return mean_of_sums(*options_.sums, attempted_at(replicate, pixel), pixel_sums(replicate, pixel), mean);
  const std::size_t channels = options_.channels;
  std::ranges::copy(
      std::as_const(held_->means).values().subspan((replicate * rect_.pixels() + pixel) * channels, channels),
      mean.begin());
}

uint64_t SpectralFilm::replicate_samples(uint32_t replicate, std::size_t pixel) const {
  require_held();
  return sums_ ? pixel_sums(replicate, pixel).count : held_->samples.at(replicate)[pixel];
}

void SpectralFilm::add_image_sums(std::vector<std::vector<double>>& sums,
                                  std::vector<uint64_t>& counts) const {
  sums.resize(options_.replicates, std::vector<double>(options_.channels));
  counts.resize(options_.replicates);
  if (sums_ && options_.held) return add_held_image_sums(sums, counts);
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
