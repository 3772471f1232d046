// SpectralFilm: what a backend adds samples to, for a rectangle of the image.
//
// The rectangle is cut into blocks of 32x32 pixels (aligned to the FULL film, as the shared wavelength
// offsets are). A backend delivers, per block and replicate, the means of the replicate's samples. Two ways
// of keeping them:
//   folded  each block finishes one replicate after the other: mean and sum of squares per channel (8 bytes);
//           if replicates come in parts, 4 more for the mean of the one that is open
//   held    the means of every replicate stay (4 R bytes, and 8 R per pixel for their counts): needed when
//   passes return to replicates (--time,
//           --target-error), for --keep-replicates and checkpoints
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "film/statistics.hpp"

namespace kiloband {

inline constexpr uint32_t kBlockSize = 32;
inline constexpr uint32_t kTileSize = 8;

/// Pixels [x0, x0 + width) x [y0, y0 + height) in full-film coordinates.
struct PixelRect {
  uint32_t x0 = 0, y0 = 0, width = 0, height = 0;

  std::size_t pixels() const { return std::size_t{width} * height; }
};

/// The blocks that cover a rectangle, clipped to it, row by row.
std::vector<PixelRect> cut_into_blocks(const PixelRect& rect);

/// The samples of one replicate in one block: per pixel their number and mean; means are [pixel][channel],
/// row by row.
struct BlockSamples {
  uint32_t block = 0;
  uint32_t replicate = 0;
  std::span<const uint32_t> counts;
  std::span<const float> means;
  std::size_t stride = 0;  // floats between pixels in means, >= channels
  uint32_t attempted = 0;  // samples per pixel, invalid ones included
};

struct FilmOptions {
  std::size_t channels = 0;  // rendered and derived
  uint32_t replicates = 1;
  bool variance = false;
  bool held = false;
  std::size_t memory_bytes = std::size_t{1}
                             << 30;  // held means that with their counts take more go to a scratch file
  bool parts = false;                // folded: several deliveries of a replicate of a block may come
};

/// What a held film consists of beside its means: small, and enough to go on with it (checkpoints).
struct HeldCounts {
  std::vector<std::vector<uint64_t>> samples;    // [replicate][pixel], valid samples
  std::vector<std::vector<uint32_t>> attempted;  // [replicate][block], samples per pixel
  std::vector<std::vector<double>>
      block_sums;  // [block][replicate * channels + channel]; empty: no sample yet
  std::vector<std::vector<uint64_t>> block_samples;  // [block][replicate]
};

/// The same where it stands: nothing is copied. Valid as long as the film.
struct HeldCountsView {
  const std::vector<std::vector<uint64_t>>& samples;
  const std::vector<std::vector<uint32_t>>& attempted;
  const std::vector<std::vector<double>>& block_sums;
  const std::vector<std::vector<uint64_t>>& block_samples;

  HeldCounts copy() const { return {samples, attempted, block_sums, block_samples}; }
};

class SpectralFilm {
 public:
  SpectralFilm(const PixelRect& rect, const FilmOptions& options);
  ~SpectralFilm();
  SpectralFilm(SpectralFilm&&) noexcept;

  const PixelRect& rect() const { return rect_; }
  const FilmOptions& options() const { return options_; }
  const std::vector<PixelRect>& blocks() const { return blocks_; }

  /// Thread-safe for different blocks. Folded films take the replicates of a block in order; several
  /// deliveries of the same replicate of a block are for held films and for those with FilmOptions::parts
  /// (the means are combined by their counts).
  void add(const BlockSamples& samples);
  /// Films with parts: what is open becomes part of the moments. To be called before anything is read; no
  /// more samples of the replicates so far may follow.
  void finish_replicates();

  /// Mean and variance of the mean of one row of pixels (y relative to the rectangle): [x][channel]. variance
  /// may be empty.
  void row(uint32_t y, std::span<float> mean, std::span<float> variance) const;
  /// Samples of a pixel (x, y relative to the rectangle).
  uint64_t samples(uint32_t x, uint32_t y) const;
  /// held films: mean of one replicate at a pixel, and its number of samples.
  std::span<const float> replicate_mean(uint32_t replicate, std::size_t pixel) const;
  uint64_t replicate_samples(uint32_t replicate, std::size_t pixel) const;
  /// held films: samples per pixel that a block has had of a replicate; where the next range begins.
  uint32_t attempted(uint32_t replicate, uint32_t block) const;
  /// held films: all means [replicate][pixel][channel] and the counts beside them, to be saved and restored.
  std::span<float> held_means();
  std::span<const float> held_means() const;
  HeldCountsView held_counts() const;
  /// throws std::logic_error if the shapes differ
  void restore(HeldCounts counts);

  /// Moments of the 8x8-pixel tiles' means (tiles are aligned to the blocks, row by row within a block: index
  /// block * 16 + (y / 8) * 4 + x / 8, coordinates relative to the block) and of the whole rectangle's mean
  /// (unit 0).
  const ReplicateMoments& tile_moments() const;
  ReplicateMoments image_moments() const;
  /// Sums over the rectangle of pixel means of a replicate times counts, and the number of samples: to be
  /// added over strips.
  void add_image_sums(std::vector<std::vector<double>>& sums, std::vector<uint64_t>& counts) const;

  /// Bytes that a film of this shape takes, per pixel.
  static std::size_t bytes_per_pixel(const FilmOptions& options);

 private:
  struct Held;
  struct Parts;
  void require_held() const;
  void add_folded(const BlockSamples& samples, const PixelRect& block);
  void add_part(const BlockSamples& samples, const PixelRect& block);
  void add_tile_part(const BlockSamples& samples, std::size_t tile, std::span<const double> sums,
                     uint64_t count);
  void fold_block(uint32_t block);
  void add_held(const BlockSamples& samples, const PixelRect& block);
  void add_coarse(const BlockSamples& samples, const PixelRect& block);
  std::size_t pixel_index(const PixelRect& block, std::size_t pixel_in_block) const;

  PixelRect rect_;
  FilmOptions options_;
  std::vector<PixelRect> blocks_;
  std::unique_ptr<ReplicateMoments> pixels_;  // folded
  std::unique_ptr<Held> held_;
  std::unique_ptr<Parts> parts_;                 // folded, replicates in parts
  std::unique_ptr<ReplicateMoments> tiles_;      // folded, with variance
  std::vector<std::vector<double>> block_sums_;  // [block][replicate * channels + channel], sum of samples
  std::vector<std::vector<uint64_t>> block_counts_;  // [block][replicate]
};

/// Mean and variance of the mean from sums over samples per replicate.
ReplicateMoments moments_of_sums(const std::vector<std::vector<double>>& sums,
                                 const std::vector<uint64_t>& counts);

}  // namespace kiloband
