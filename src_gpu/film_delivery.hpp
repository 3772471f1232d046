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
  bool in_block() const { return collected_.pixels() > 0; }
  uint32_t attempted() const { return collected_.attempted; }
  std::size_t missing() const { return film_.blocks()[blocks_[next_block_]].pixels() - collected_.pixels(); }

  /// The film's sums of these pixels, of the samples before the range, into memory that is there. Pixels are dealt to threads.
  void read_sums(std::span<const ImagePixel> pixels, FilmSums& sums) const;
  /// The pixels follow those that were added before: the rest of a block, or whole blocks, or a part of one. Blocks are dealt to threads.
  void add(const GroupResult& result);

 private:
  std::size_t index(const ImagePixel& pixel) const;
  void put_sums(const FilmSums& sums, uint32_t attempted, std::size_t first, const PixelRect& block);
  std::size_t finish_blocks(const GroupResult& result);
  void finish_block(const GroupResult& result, std::size_t first, uint32_t block);

  SpectralFilm& film_;
  const SampleRange& range_;
  const std::vector<uint32_t>& blocks_;
  std::size_t channels_, next_block_ = 0;
  GroupResult collected_;  // of the block that is open
};

/// All blocks of a folded film become what their replicates have come to; some at a time, which are dealt to threads.
/// Where it throws, some blocks are, and some are as they were.
void deliver_replicates(SpectralFilm& film, DeviceReplicates& replicates);
/// No block of a folded film has a replicate.
void forget_replicates(SpectralFilm& film);

}  // namespace kiloband::opencl
