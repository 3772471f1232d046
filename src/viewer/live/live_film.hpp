// The film of a render that is looked at while it refines.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "viewer/display/plane.hpp"

namespace kiloband::viewer {

/// Samples come one per pixel and pass, over all blocks or some of them at a time. They are dealt to replicates that
/// follow each other (SpectralFilm's folded ones), so that memory does not grow with their number: 1, 1, 2, 4 and 8
/// samples first, so that there are error bars from the third pass on, then 12 replicates each of 16 and of 32 samples,
/// and 64 from there on. A value takes 15 bytes, on OpenCL 23; without error bars 10 and 18.
class LiveFilm final : public PixelSource {
 public:
  /// rect   of the full film
  /// bands  film channels in their order; units: W m^-2 sr^-1 of a film value of 1
  /// throws DeviceError  no memory
  LiveFilm(const PixelRect& rect, std::vector<Band> bands, std::vector<double> units, const SumRule& rule,
           bool variance);
  LiveFilm(const LiveFilm&) = delete;  // which the film's observer points to
  LiveFilm& operator=(const LiveFilm&) = delete;

  static std::size_t bytes(const PixelRect& rect, std::size_t channels, const SumRule& rule, bool variance);
  /// The replicates of SamplingSettings.
  static constexpr uint32_t kReplicates = 256;
  /// Of a pixel.
  static uint64_t most_samples();

  /// Forgets all samples; the memory stays.
  void restart();
  SpectralFilm& film() { return film_; }
  /// What the blocks of this pass get; to be given to Backend::render() with some of next_blocks().
  SampleRange range() const { return {replicate_, first_, 1}; }
  /// At most `most` blocks that have not had it.
  std::vector<uint32_t> next_blocks(std::size_t most) const;
  /// To be called after rendering. True: all blocks have had their sample, and a new pass begins.
  bool finish_pass();
  uint64_t passes() const { return passes_; }
  /// Of the pixel that has the fewest.
  uint64_t samples() const { return passes_; }
  std::size_t blocks() const { return film_.blocks().size(); }

  uint32_t width() const override { return film_.rect().width; }
  uint32_t height() const override { return film_.rect().height; }
  const std::vector<Band>& bands() const override { return bands_; }
  const std::vector<double>& units() const override { return units_; }
  void means(uint32_t y, std::span<float> out) const override;
  bool has_variances() const override { return film_.options().variance; }
  void variances(uint32_t y, std::span<float> out) const override;
  /// The closed ones.
  uint32_t replicates() const override { return has_variances() ? replicate_ : 0; }
  bool has_independent_errors() const override { return independent_errors_; }
  /// Of paths that have wavelengths of their own: pixels of a block share nothing.
  void set_independent_errors() { independent_errors_ = true; }
  void sums(uint32_t y, const ThreeSums& of_row, std::span<float> out) const override;
  void prepare(const ThreeSums& sums) const override;

 private:
  /// Three sums of all pixels, so that a picture does not read every channel. Of the closed replicates' means: they change with
  /// every 16th pass or less. Of the open replicate: they are made as soon as a block has got its sample, by the thread that
  /// has its channels in the caches.
  struct KeptSums {
    ThreeSums sums;
    uint64_t asked;                   // passes() when they were asked for last
    std::vector<float> closed, open;  // [pixel][3]
    std::vector<uint32_t> samples;    // [pixel]: that `closed` is of
    std::vector<uint64_t> additions;  // [block]: after which of them `open` was made; 0: never
  };
  void add_block(uint32_t block);
  void update_closed(uint32_t y, KeptSums& kept) const;
  void add_open(uint32_t y, uint32_t x, std::span<float> mean) const;

  SpectralFilm film_;
  std::vector<Band> bands_;
  std::vector<double> units_;
  bool independent_errors_ = false;
  std::vector<uint64_t> additions_;  // [block]: how often its sums have been added to
  uint32_t replicate_ = 0, first_ = 0;
  mutable std::deque<KeptSums> kept_;  // of the sums that were asked for last; rows belong to who reads them
  uint64_t passes_ = 0;
};

}  // namespace kiloband::viewer
