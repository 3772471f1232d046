#include "src_gpu/film_delivery.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

namespace kiloband::opencl {
namespace {

template <class Value>
void append(std::vector<Value>& to, std::vector<Value>& from) {
  if (to.empty()) return to.swap(from);
  to.insert(to.end(), from.begin(), from.end());
}

template <class Value>
void erase_front(std::vector<Value>& values, std::size_t number) {
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(std::min(number, values.size())));
}

}  // namespace

FilmDelivery::FilmDelivery(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
                           std::size_t channels)
    : film_(film), range_(range), blocks_(blocks), channels_(channels) {
  if (!film.keeps_sums()) return;
  for (const uint32_t block : blocks) {
    film.open_replicate(range.replicate, block);
    if (film.attempted(range.replicate, block) != range.first)
      throw std::logic_error("OpenCL backend: the samples do not follow those that the film has");
  }
}

std::size_t FilmDelivery::index(const ImagePixel& pixel) const {
  const PixelRect& rect = film_.rect();
  return std::size_t{pixel.y - rect.y0} * rect.width + pixel.x - rect.x0;
}

FilmSums FilmDelivery::sums_of(std::span<const ImagePixel> pixels) const {
  const std::size_t values = pixels.size() * channels_;
  FilmSums sums{std::vector<float>(values), std::vector<float>(values), std::vector<float>(values),
                std::vector<uint32_t>(pixels.size())};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const PixelSumsView from = std::as_const(film_).pixel_sums(range_.replicate, index(pixels[i]));
    sums.counts[i] = from.count;
    std::ranges::copy(from.open, sums.open.begin() + static_cast<std::ptrdiff_t>(i * channels_));
    for (std::size_t c = 0; c < from.closed.size(); ++c) {
      const auto closed = std::bit_cast<CompensatedSum>(from.closed[c]);
      sums.sum[i * channels_ + c] = closed.sum;
      sums.lost[i * channels_ + c] = closed.lost;
    }
  }
  return sums;
}

/// The block's pixels are those from `first` on of what is collected.
void FilmDelivery::put_sums(std::size_t first, const PixelRect& block) {
  for (std::size_t i = 0; i < block.pixels(); ++i) {
    const PixelSums to = film_.pixel_sums(range_.replicate, film_.pixel_index(block, i));
    const std::size_t values = (first + i) * channels_;
    to.count = sums_.counts[first + i];
    std::copy_n(&sums_.open[values], channels_, to.open.begin());
    for (std::size_t c = 0; c < to.closed.size(); ++c)
      to.closed[c] = std::bit_cast<ClosedSum>(CompensatedSum{sums_.sum[values + c], sums_.lost[values + c]});
  }
}

void FilmDelivery::add(std::span<const ImagePixel> pixels, GroupResult result) {
  append(means_, result.means);
  append(counts_, result.counts);
  append(sums_.sum, result.sums.sum);
  append(sums_.lost, result.sums.lost);
  append(sums_.open, result.sums.open);
  append(sums_.counts, result.sums.counts);
  attempted_.insert(attempted_.end(), pixels.size(), result.attempted);
  std::size_t first = 0;
  while (next_block_ < blocks_.size()) {
    const std::size_t in_block = film_.blocks()[blocks_[next_block_]].pixels();
    if (first + in_block > attempted_.size()) break;
    if (film_.keeps_sums()) put_sums(first, film_.blocks()[blocks_[next_block_]]);
    finish_block(first, in_block);
    first += in_block;
    ++next_block_;
  }
  for (std::vector<float>* values : {&means_, &sums_.sum, &sums_.lost, &sums_.open})
    erase_front(*values, first * channels_);
  for (std::vector<uint32_t>* values : {&counts_, &sums_.counts, &attempted_}) erase_front(*values, first);
}

/// Pixels first .. first + pixels - 1 of what is collected are the next block.
void FilmDelivery::finish_block(std::size_t first, std::size_t pixels) {
  const uint32_t block = blocks_[next_block_];
  if (film_.keeps_sums())
    return film_.set_attempted(range_.replicate, block, range_.first + attempted_[first]);
  const auto block_means = std::span(means_).subspan(first * channels_, pixels * channels_);
  film_.add({block, range_.replicate, std::span(counts_).subspan(first, pixels), block_means, channels_});
}

}  // namespace kiloband::opencl
