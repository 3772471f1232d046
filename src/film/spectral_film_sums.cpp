#include "film/spectral_film_sums.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace kiloband {

void SpectralFilm::require_sums() const {
  if (!sums_) throw std::logic_error("SpectralFilm: no sums are kept");
}

uint32_t SpectralFilm::attempted(uint32_t replicate, uint32_t block) const {
  require_sums();
  if (!options_.held) return sums_->open.at(block) == replicate ? sums_->attempted[0][block] : 0;
  return sums_->attempted.at(replicate).at(block);
}

void SpectralFilm::open_replicate(uint32_t replicate, uint32_t block) {
  require_sums();
  if (replicate >= options_.replicates) throw std::logic_error("SpectralFilm: no such replicate");
  if (options_.held || sums_->open.at(block) == replicate) return;
  fold_block(block);
  if (!sums_->stale.empty() && sums_->stale[block]) {
    for (std::size_t p = 0; p < blocks_[block].pixels(); ++p) clear_pixel(pixel_index(blocks_[block], p));
    sums_->stale[block] = 0;
  }
  sums_->open[block] = replicate;
}

/// Sums are cleared block by block when one is opened: by threads that work on different blocks, in their caches.
void SpectralFilm::restart() {
  require_sums();
  if (options_.held) throw std::logic_error("SpectralFilm::restart: replicates are held");
  sums_->break_seal();
  pixels_->restart();
  sums_->values.forget_counts();
  std::ranges::fill(sums_->attempted[0], 0);
  std::ranges::fill(sums_->open, Sums::kNone);
  sums_->stale.assign(blocks_.size(), 1);
  for (std::vector<double>& sums : block_sums_) std::ranges::fill(sums, 0.0);
  for (std::vector<uint64_t>& counts : block_counts_) std::ranges::fill(counts, 0);
}

void SpectralFilm::clear_pixel(std::size_t pixel) {
  const PixelSums sums = pixel_sums(0, pixel);
  sums.count = 0;
  std::ranges::fill(sums.open, 0.0f);
  std::ranges::fill(sums.closed, ClosedSum{0});
}

PixelSums SpectralFilm::pixel_sums(uint32_t replicate, std::size_t pixel) {
  require_sums();
  sums_->break_seal();
  return sums_->values.at(options_.held ? replicate : 0, pixel);
}

PixelSumsView SpectralFilm::pixel_sums(uint32_t replicate, std::size_t pixel) const {
  require_sums();
  return std::as_const(sums_->values).at(options_.held ? replicate : 0, pixel);
}

OpenSums SpectralFilm::open_sums(uint32_t replicate, std::size_t pixel, std::size_t pixels) {
  require_sums();
  sums_->break_seal();
  return sums_->values.open(options_.held ? replicate : 0, pixel, pixels);
}

OpenSumsView SpectralFilm::open_sums(uint32_t replicate, std::size_t pixel, std::size_t pixels) const {
  require_sums();
  return std::as_const(sums_->values).open(options_.held ? replicate : 0, pixel, pixels);
}

void SpectralFilm::set_attempted(uint32_t replicate, uint32_t block, uint32_t attempted) {
  require_sums();
  sums_->break_seal();
  sums_->attempted.at(options_.held ? replicate : 0).at(block) = attempted;
  if (sums_->observer) sums_->observer(block);
}

uint64_t SpectralFilm::seal_sums() {
  static std::atomic<uint64_t> last{0};
  require_sums();
  return sums_->seal = ++last;
}

uint64_t SpectralFilm::seal() const {
  require_sums();
  return sums_->seal;
}

void SpectralFilm::observe(std::function<void(uint32_t block)> observer) {
  require_sums();
  sums_->observer = std::move(observer);
}

uint32_t SpectralFilm::block_of(std::size_t pixel) const {
  const std::size_t x = rect_.x0 + pixel % rect_.width, y = rect_.y0 + pixel / rect_.width;
  const std::size_t per_row = (rect_.x0 + rect_.width - 1) / kBlockSize - rect_.x0 / kBlockSize + 1;
  const std::size_t column = x / kBlockSize - rect_.x0 / kBlockSize;
  const std::size_t row = y / kBlockSize - rect_.y0 / kBlockSize;
  return static_cast<uint32_t>(row * per_row + column);
}

uint32_t SpectralFilm::attempted_at(uint32_t replicate, std::size_t pixel) const {
  return attempted(replicate, block_of(pixel));
}

/// use(pixel in the block, its valid samples, their means) for all pixels of a block, one after the other: while means are in the first
/// cache, all that is made of them is.
template <class Use>
void SpectralFilm::each_mean(uint32_t replicate, uint32_t block, const Use& use) const {
  const uint32_t tried = attempted(replicate, block);
  std::vector<float> means(options_.channels);
  for (std::size_t p = 0; p < blocks_[block].pixels(); ++p) {
    const PixelSumsView sums = pixel_sums(replicate, pixel_index(blocks_[block], p));
    mean_of_sums(*options_.sums, tried, sums, means);
    use(p, sums.count, std::span<const float>(means));
  }
}

/// Moves the open replicate of a block into the moments; nothing is open then.
void SpectralFilm::fold_block(uint32_t block) {
  const uint32_t replicate = sums_->open[block];
  if (replicate == Sums::kNone) return;
  Coarse coarse(options_.channels);
  each_mean(replicate, block, [&](std::size_t p, uint32_t count, std::span<const float> means) {
    const std::size_t pixel = pixel_index(blocks_[block], p);
    pixels_->add(pixel, count, means);
    coarse.add(blocks_[block], p, count, means, 1);
    clear_pixel(pixel);
  });
  add_coarse(replicate, block, coarse);
  sums_->attempted[0][block] = 0;
  sums_->open[block] = Sums::kNone;
}

/// As if the open replicate of a block, if there is one, had not begun.
void SpectralFilm::forget_open(uint32_t block) {
  sums_->break_seal();
  if (sums_->open[block] == Sums::kNone) return;
  for (std::size_t p = 0; p < blocks_[block].pixels(); ++p) clear_pixel(pixel_index(blocks_[block], p));
  sums_->attempted[0][block] = 0;
  sums_->open[block] = Sums::kNone;
}

void SpectralFilm::finish_replicates() {
  if (!sums_ || options_.held) return;
  for (uint32_t block = 0; block < blocks_.size(); ++block) fold_block(block);
}

/// What add_coarse() would have gathered, made from the sums that are there now.
void SpectralFilm::add_held_image_sums(std::vector<std::vector<double>>& sums,
                                       std::vector<uint64_t>& counts) const {
  const std::size_t channels = options_.channels;
  std::vector<double> of_block(channels);
  for (uint32_t block = 0; block < blocks_.size(); ++block) {
    for (uint32_t r = 0; r < options_.replicates; ++r) {
      if (attempted(r, block) == 0) continue;
      Coarse coarse(channels);
      each_mean(r, block, [&](std::size_t p, uint32_t count, std::span<const float> means) {
        coarse.add(blocks_[block], p, count, means, 1);
      });
      std::ranges::fill(of_block, 0.0);
      for (std::size_t tile = 0; tile < kTilesPerBlock; ++tile) {
        if (coarse.counts[tile] == 0) continue;
        for (std::size_t c = 0; c < channels; ++c) of_block[c] += coarse.sums[tile * channels + c];
        counts[r] += coarse.counts[tile];
      }
      for (std::size_t c = 0; c < channels; ++c) sums[r][c] += of_block[c];
    }
  }
}

}  // namespace kiloband
