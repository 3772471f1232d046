// SpectralFilm: what a backend adds samples to, for a rectangle of the image.
//
// The rectangle is cut into blocks of 32x32 pixels (aligned to the FULL film, as the shared wavelength
// offsets are). Two ways of keeping what the replicates of a block come to:
//   folded  one after the other: mean and sum of squares of their means, per channel (8 bytes)
//   held    the means of all of them stay (4 R bytes, and 8 R per pixel for their counts): --keep-replicates
// A backend delivers a replicate of a block at once, as means. Where replicates come in parts, the film keeps
// sums (FilmOptions::sums, replicate_sums.hpp), of the replicate that is open in each block (folded: 4 or 12
// bytes more per value) or of all of them (held: 4 R or 12 R bytes, and 4 R per pixel), and a backend goes on
// from them: when passes return to replicates (--time, --target-error), and for checkpoints.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "film/replicate_sums.hpp"
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

/// All samples of one replicate in one block: per pixel their number and mean;
/// means are [pixel][channel], row by row, each times its pixel's factor: sums of samples become means on the way.
struct BlockSamples {
  uint32_t block = 0;
  uint32_t replicate = 0;
  std::span<const uint32_t> counts;
  std::span<const float> means;
  std::size_t stride = 0;          // floats between pixels in means, >= channels
  std::span<const float> factors;  // [pixel], or empty: 1

  float factor(std::size_t pixel) const { return factors.empty() ? 1.0f : factors[pixel]; }
};

/// What the first replicates of a block have come to, as add() of one after the other makes it; values are [pixel][channel].
struct BlockMoments {
  uint32_t block = 0;
  std::span<const uint64_t> samples;     // [pixel], of all replicates
  std::span<const uint32_t> replicates;  // [pixel], those with samples
  std::span<const float> mean, m2;       // m2: of films with variances
  std::span<const double> sums;          // [replicate][channel], of the block's samples
  std::span<const uint64_t> counts;      // [replicate]: their number
};

struct FilmOptions {
  std::size_t channels = 0;  // rendered and derived
  uint32_t replicates = 1;
  bool variance = false;
  bool held = false;
  std::size_t memory_bytes = std::size_t{1}
                             << 30;  // what is held beyond this, counts included, goes to a scratch file
  std::optional<SumRule> sums;       // the backend's: replicates come in parts
  uint32_t most_samples = ~0u;       // per replicate, of films that keep sums
};

class SpectralFilm {
 public:
  SpectralFilm(const PixelRect& rect, const FilmOptions& options);
  ~SpectralFilm();
  SpectralFilm(SpectralFilm&&) noexcept;

  const PixelRect& rect() const { return rect_; }
  const FilmOptions& options() const { return options_; }
  const std::vector<PixelRect>& blocks() const { return blocks_; }
  /// The numbers of all of them, as Backend::render() wants them.
  std::vector<uint32_t> all_blocks() const;

  /// Folded films that keep sums: becomes as it was when it was made, in the same memory.
  void restart();

  /// Thread-safe for different blocks. Folded films take the replicates of a block in order.
  /// Not for films that keep sums.
  void add(const BlockSamples& samples);
  /// A block of a folded film becomes this, whatever it was, and no replicate is open there; thread-safe for different blocks. More
  /// replicates may follow.
  void set(const BlockMoments& moments);
  /// Whether add() or set() has had this replicate of the block.
  bool has(uint32_t replicate, uint32_t block) const;

  /// What follows is for films that keep sums, and thread-safe for different blocks.
  bool keeps_sums() const { return sums_ != nullptr; }
  /// Samples per pixel, invalid ones included, that a block has had of a replicate: where the next delivery
  /// begins. Folded films: of the replicate that is open, 0 of all others.
  uint32_t attempted(uint32_t replicate, uint32_t block) const;
  /// To be called before the sums of a block are touched. Folded films: the replicate before becomes part of
  /// the moments, and this one begins.
  void open_replicate(uint32_t replicate, uint32_t block);
  /// pixel: index in the rectangle, see pixel_index()
  PixelSums pixel_sums(uint32_t replicate, std::size_t pixel);
  PixelSumsView pixel_sums(uint32_t replicate, std::size_t pixel) const;
  /// Of pixels of one row of the rectangle.
  OpenSums open_sums(uint32_t replicate, std::size_t pixel, std::size_t pixels);
  OpenSumsView open_sums(uint32_t replicate, std::size_t pixel, std::size_t pixels) const;
  std::size_t pixel_index(const PixelRect& block, std::size_t pixel_in_block) const;
  /// Which block a pixel of the rectangle lies in.
  uint32_t block_of(std::size_t pixel) const;
  /// To be called once the sums have all samples before this one.
  void set_attempted(uint32_t replicate, uint32_t block, uint32_t attempted);
  /// The observer is called at the end of set_attempted(), by the thread that has added to the block's sums, which are in
  /// its caches then. It must not be changed meanwhile.
  void observe(std::function<void(uint32_t block)> observer);
  /// A number that no film's sums have had before. seal() is it until anything may have changed these, and 0 from then on: who has a copy of
  /// them elsewhere need not read them again.
  uint64_t seal_sums();
  uint64_t seal() const;
  /// Folded films: what is open becomes part of the moments. To be called before anything is read; no more
  /// samples of the replicates so far may follow.
  void finish_replicates();

  /// Mean and variance of the mean of one row of pixels (y relative to the rectangle): [x][channel].
  /// variance may be empty.
  void row(uint32_t y, std::span<float> mean, std::span<float> variance) const;
  /// Samples of a pixel (x, y relative to the rectangle).
  uint64_t samples(uint32_t x, uint32_t y) const;
  /// Its replicates that have any.
  uint32_t replicates(uint32_t x, uint32_t y) const;
  /// held films: mean of one replicate at a pixel, one entry per channel, and its number of samples.
  void replicate_mean(uint32_t replicate, std::size_t pixel, std::span<float> mean) const;
  uint64_t replicate_samples(uint32_t replicate, std::size_t pixel) const;

  /// Moments of the whole rectangle's mean (unit 0).
  ReplicateMoments image_moments() const;
  /// Sums over the rectangle of pixel means of a replicate times counts, and the number of samples: to be
  /// added over strips.
  void add_image_sums(std::vector<std::vector<double>>& sums, std::vector<uint64_t>& counts) const;

  /// Bytes that a film of this shape takes, per pixel.
  static std::size_t bytes_per_pixel(const FilmOptions& options);

 private:
  struct Held;
  struct Sums;
  struct Coarse;
  void require_held() const;
  void require_sums() const;
  uint32_t attempted_at(uint32_t replicate, std::size_t pixel) const;
  void add_pixels(const BlockSamples& samples);
  void add_held(const BlockSamples& samples, std::size_t pixel_in_block);
  void add_coarse(uint32_t replicate, uint32_t block, const Coarse& coarse);
  void set_coarse(const BlockMoments& moments);
  void fold_block(uint32_t block);
  void forget_open(uint32_t block);
  void clear_pixel(std::size_t pixel);
  template <class Use>
  void each_mean(uint32_t replicate, uint32_t block, const Use& use) const;
  void add_held_image_sums(std::vector<std::vector<double>>& sums, std::vector<uint64_t>& counts) const;

  PixelRect rect_;
  FilmOptions options_;
  std::vector<PixelRect> blocks_;
  std::unique_ptr<ReplicateMoments> pixels_;  // folded
  std::unique_ptr<Held> held_;                // held means
  std::unique_ptr<Sums> sums_;
  std::vector<std::vector<double>> block_sums_;  // [block][replicate * channels + channel], sum of samples
  std::vector<std::vector<uint64_t>> block_counts_;  // [block][replicate]
  std::vector<std::vector<char>> added_;             // [block][replicate] of films without sums
};

/// Mean and variance of the mean from sums over samples per replicate.
ReplicateMoments moments_of_sums(const std::vector<std::vector<double>>& sums,
                                 const std::vector<uint64_t>& counts);

}  // namespace kiloband
