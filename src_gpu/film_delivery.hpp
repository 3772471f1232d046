// What groups of pixels deliver, handed to the film.
#pragma once

#include <span>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "src_gpu/group_renderer.hpp"

namespace kiloband::opencl {

/// Collects the results of groups and hands complete blocks to the film: what fails in the middle of a block
/// leaves nothing of it there. References must outlive it.
class FilmDelivery {
 public:
  /// channels  derived ones included
  /// throws std::logic_error  the film keeps sums, but not those of the samples before the range
  FilmDelivery(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
               std::size_t channels);

  /// A block is delivered in part: the samples per pixel that its first part has,
  /// and the pixels that it lacks.
  bool in_block() const { return !attempted_.empty(); }
  uint32_t attempted() const { return attempted_.front(); }
  std::size_t missing() const { return film_.blocks()[blocks_[next_block_]].pixels() - attempted_.size(); }

  /// The film's sums of these pixels, of the samples before the range.
  FilmSums sums_of(std::span<const ImagePixel> pixels) const;
  /// The pixels follow those that were added before.
  void add(std::span<const ImagePixel> pixels, GroupResult result);

 private:
  std::size_t index(const ImagePixel& pixel) const;
  void put_sums(std::size_t first, const PixelRect& block);
  void finish_block(std::size_t first, std::size_t pixels);

  SpectralFilm& film_;
  const SampleRange& range_;
  const std::vector<uint32_t>& blocks_;
  std::size_t channels_, next_block_ = 0;
  std::vector<float> means_;
  std::vector<uint32_t> counts_;
  FilmSums sums_;
  std::vector<uint32_t> attempted_;  // by pixel of the open block and those after it
};

}  // namespace kiloband::opencl
