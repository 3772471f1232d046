#include "render/devices/staged_sums.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>

namespace kiloband {
namespace {

/// What the blocks lie in.
PixelRect hull_of(const SpectralFilm& film, std::span<const uint32_t> blocks) {
  uint32_t x0 = ~0u, y0 = ~0u, x1 = 0, y1 = 0;
  for (const uint32_t b : blocks) {
    const PixelRect& block = film.blocks()[b];
    x0 = std::min(x0, block.x0), x1 = std::max(x1, block.x0 + block.width);
    y0 = std::min(y0, block.y0), y1 = std::max(y1, block.y0 + block.height);
  }
  return {x0, y0, x1 - x0, y1 - y0};
}

/// How many of the first blocks go together: those that fill at least half of what they lie in.
std::size_t compact_blocks(const SpectralFilm& film, std::span<const uint32_t> blocks) {
  std::size_t pixels = 0, number = 0;
  while (number < blocks.size()) {
    pixels += film.blocks()[blocks[number]].pixels();
    if (hull_of(film, blocks.first(number + 1)).pixels() > 2 * pixels) break;
    ++number;
  }
  return number;
}

/// The numbers that `blocks` of a film have in another, which covers them.
std::vector<uint32_t> numbers_in(const SpectralFilm& other, const SpectralFilm& film,
                                 std::span<const uint32_t> blocks) {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> at;
  for (uint32_t b = 0; b < other.blocks().size(); ++b) at[{other.blocks()[b].x0, other.blocks()[b].y0}] = b;
  std::vector<uint32_t> numbers;
  for (const uint32_t b : blocks) numbers.push_back(at.at({film.blocks()[b].x0, film.blocks()[b].y0}));
  return numbers;
}

/// Adds the samples of a block of `from` after the first range.first to one of `to`.
void add_block(const SpectralFilm& from, uint32_t source, SpectralFilm& to, uint32_t target,
               const SampleRange& range) {
  const PixelRect& block = to.blocks()[target];
  const uint32_t attempted = from.attempted(range.replicate, source);
  std::vector<float> mean(to.options().channels);
  for (std::size_t p = 0; p < block.pixels(); ++p) {
    const PixelSumsView sums = from.pixel_sums(range.replicate, from.pixel_index(block, p));
    mean_of_sums(*from.options().sums, attempted, sums, mean);
    const PixelSums out = to.pixel_sums(range.replicate, to.pixel_index(block, p));
    out.count += sums.count;
    for (std::size_t c = 0; c < mean.size(); ++c)
      out.closed[c] =
          std::bit_cast<ClosedSum>(std::bit_cast<double>(out.closed[c]) + double{mean[c]} * sums.count);
  }
  to.set_attempted(range.replicate, target, attempted);
}

/// By way of a film of what the blocks lie in.
void render_through(Backend& backend, const SumRule& rule, SpectralFilm& film, const SampleRange& range,
                    std::span<const uint32_t> blocks, const std::atomic<bool>& stop,
                    const std::function<void(uint64_t)>& progress) {
  FilmOptions options;
  options.channels = film.options().channels;
  options.replicates = film.options().replicates;
  options.memory_bytes = film.options().memory_bytes;
  options.sums = rule;
  options.most_samples = range.first + range.count;
  SpectralFilm own(hull_of(film, blocks), options);
  const std::vector<uint32_t> numbers = numbers_in(own, film, blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    film.open_replicate(range.replicate, blocks[i]);
    if (film.attempted(range.replicate, blocks[i]) != range.first)
      throw std::logic_error("render_staged: the samples do not follow those that the film has");
    own.open_replicate(range.replicate, numbers[i]);
    own.set_attempted(range.replicate, numbers[i], range.first);  // as if they all had been 0
  }
  backend.render(own, range, numbers, stop, progress);
  for (std::size_t i = 0; i < blocks.size(); ++i) add_block(own, numbers[i], film, blocks[i], range);
}

}  // namespace

std::size_t staged_bytes_of_block(std::size_t channels) {
  return std::size_t{kBlockSize} * kBlockSize * channels * 4 * sizeof(float);
}

void render_staged(Backend& backend, const SumRule& rule, SpectralFilm& film, const SampleRange& range,
                   const std::vector<uint32_t>& blocks, const std::atomic<bool>& stop,
                   const std::function<void(uint64_t)>& progress) {
  for (std::span<const uint32_t> left = blocks; !left.empty();) {
    const std::span<const uint32_t> some = left.first(compact_blocks(film, left));
    render_through(backend, rule, film, range, some, stop, progress);
    left = left.subspan(some.size());
  }
}

}  // namespace kiloband
