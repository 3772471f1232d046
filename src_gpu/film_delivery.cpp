#include "src_gpu/film_delivery.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

#include "base/deal_ranges.hpp"

namespace kiloband::opencl {
namespace {

/// What a thread has to do for a film value, in bytes of memory.
constexpr uint64_t kBytesOfValue = 16;
/// Values of replicates that are brought to the host together: 64 MiB of means.
constexpr std::size_t kValuesAtOnce = std::size_t{1} << 24;

template <class Value>
void append(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(GroupResult& to, const GroupResult& from) {
  append(to.means, from.means);
  append(to.counts, from.counts);
  append(to.sums.sum, from.sums.sum);
  append(to.sums.lost, from.sums.lost);
  append(to.sums.open, from.sums.open);
  append(to.sums.counts, from.sums.counts);
  to.attempted = from.attempted;
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

void FilmDelivery::read_sums(std::span<const ImagePixel> pixels, FilmSums& sums) const {
  for (auto* values : {&sums.open, &sums.sum, &sums.lost}) values->resize(pixels.size() * channels_);
  sums.counts.resize(pixels.size());
  const auto read = [&](std::size_t i) {
    const PixelSumsView from = std::as_const(film_).pixel_sums(range_.replicate, index(pixels[i]));
    const std::size_t first = i * channels_;
    sums.counts[i] = from.count;
    std::ranges::copy(from.open, &sums.open[first]);
    for (std::size_t c = 0; c < channels_; ++c) {
      const auto closed =
          from.closed.empty() ? CompensatedSum{} : std::bit_cast<CompensatedSum>(from.closed[c]);
      sums.sum[first + c] = closed.sum;
      sums.lost[first + c] = closed.lost;
    }
  };
  deal_ranges(pixels.size(), threads_for(kBytesOfValue * channels_ * pixels.size()),
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) read(i);
              });
}

/// The block's pixels are those from `first` on. A round of the first chunk alone that was meant to have others behind it has gone to the
/// device's closed sums; in the film a full chunk stays open.
void FilmDelivery::put_sums(const FilmSums& sums, uint32_t attempted, std::size_t first,
                            const PixelRect& block) {
  const bool in_first_chunk = attempted <= film_.options().sums->chunk;
  for (std::size_t i = 0; i < block.pixels(); ++i) {
    const PixelSums to = film_.pixel_sums(range_.replicate, film_.pixel_index(block, i));
    const std::size_t values = (first + i) * channels_;
    to.count = sums.counts[first + i];
    for (std::size_t c = 0; c < channels_; ++c) {
      CompensatedSum closed{sums.sum[values + c], sums.lost[values + c]};
      to.open[c] = sums.open[values + c];
      if (in_first_chunk && closed.sum != 0) {
        to.open[c] += closed.sum + closed.lost;
        closed = {};
      }
      if (!to.closed.empty()) to.closed[c] = std::bit_cast<ClosedSum>(closed);
    }
  }
}

void FilmDelivery::add(const GroupResult& result) {
  if (!in_block()) {
    if (finish_blocks(result) == 0) collected_ = result;
    return;
  }
  append(collected_, result);
  if (finish_blocks(collected_) > 0) collected_ = {};
}

/// The blocks that are complete. Returns their number.
std::size_t FilmDelivery::finish_blocks(const GroupResult& result) {
  std::vector<std::size_t> firsts;
  std::size_t first = 0;
  for (std::size_t next = next_block_; next < blocks_.size(); ++next) {
    const std::size_t in_block = film_.blocks()[blocks_[next]].pixels();
    if (first + in_block > result.pixels()) break;
    firsts.push_back(first);
    first += in_block;
  }
  if (!firsts.empty() && first != result.pixels())
    throw std::logic_error("OpenCL backend: pixels of a block that is not complete follow whole blocks");
  const unsigned threads = threads_for(kBytesOfValue * channels_ * first);
  deal_ranges(firsts.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) finish_block(result, firsts[b], blocks_[next_block_ + b]);
  });
  next_block_ += firsts.size();
  return firsts.size();
}

/// The block's pixels are those from `first` on.
void FilmDelivery::finish_block(const GroupResult& result, std::size_t first, uint32_t block) {
  if (film_.keeps_sums()) {
    const uint32_t attempted = range_.first + result.attempted;
    put_sums(result.sums, attempted, first, film_.blocks()[block]);
    return film_.set_attempted(range_.replicate, block, attempted);
  }
  const std::size_t pixels = film_.blocks()[block].pixels();
  const auto means = std::span(result.means).subspan(first * channels_, pixels * channels_);
  film_.add({block, range_.replicate, std::span(result.counts).subspan(first, pixels), means, channels_, {}});
}

void deliver_replicates(SpectralFilm& film, DeviceReplicates& replicates) {
  const std::vector<PixelRect>& blocks = film.blocks();
  const std::size_t channels = film.options().channels;
  const FoldedReplicates& folded = replicates.folded();
  std::vector<float> mean, m2;
  for (std::size_t block = 0, pixel = 0; block < blocks.size();) {
    std::vector<std::size_t> firsts;  // of the blocks that are brought together
    std::size_t pixels = 0;
    for (std::size_t b = block; b < blocks.size() && (pixels == 0 || pixels * channels < kValuesAtOnce);
         ++b) {
      firsts.push_back(pixels);
      pixels += blocks[b].pixels();
    }
    replicates.bring({pixel, pixels}, mean, m2);
    const auto deliver = [&](std::size_t i) {
      const std::size_t first = firsts[i], number = blocks[block + i].pixels();
      const auto values = [&](const std::vector<float>& all) {
        return std::span(all).subspan(first * channels, number * channels);
      };
      film.set({static_cast<uint32_t>(block + i), std::span(folded.samples).subspan(pixel + first, number),
                std::span(folded.replicates).subspan(pixel + first, number), values(mean),
                film.options().variance ? values(m2) : std::span<const float>(), folded.sums[block + i],
                folded.counts[block + i]});
    };
    deal_ranges(firsts.size(), threads_for(kBytesOfValue * mean.size()),
                [&](std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin; i < end; ++i) deliver(i);
                });
    block += firsts.size();
    pixel += pixels;
  }
}

void forget_replicates(SpectralFilm& film) {
  for (uint32_t b = 0; b < film.blocks().size(); ++b) {
    const std::size_t pixels = film.blocks()[b].pixels();
    const std::vector<uint64_t> samples(pixels);
    const std::vector<uint32_t> replicates(pixels);
    const std::vector<float> values(pixels * film.options().channels);
    film.set({b,
              samples,
              replicates,
              values,
              film.options().variance ? std::span<const float>(values) : std::span<const float>(),
              {},
              {}});
  }
}

}  // namespace kiloband::opencl
