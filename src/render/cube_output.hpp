// Film rows to files: scales film values to W m^-2 sr^-1, feeds all writers and the preview,
// gathers the error figure.
#pragma once

#include <future>
#include <memory>
#include <vector>

#include "render/band_scale.hpp"
#include "render/error_sums.hpp"
#include "render/session.hpp"

namespace kiloband {

class CubeOutput {
 public:
  /// Opens all files, so that hours of rendering do not end at a name or a full disk.
  /// rows_per_strip as create_cube_writer(); film_scale per film channel
  CubeOutput(const FlatScene& scene, const BandSelection& bands, const std::vector<double>& film_scale,
             const SessionSettings& settings, uint32_t replicates, uint32_t rows_per_strip);

  /// What the files state: before the first rows, and again before finish() where it has come to less.
  void set_counts(const SampleCounts& counts);
  /// Rows that are best written at once (the last may be fewer).
  uint32_t rows_at_once() const { return strip_; }
  /// Appends rows y .. y + rows - 1 of a film that covers the next rows of the image, at most rows_at_once().
  /// auxiliary  their pixels, where settings.aux asks for images
  void write(const SpectralFilm& film, uint32_t y, uint32_t rows, std::span<const AuxiliaryPixel> auxiliary);
  /// The replicates of a film whose rows were the last to be written.
  void write_replicates(const SpectralFilm& film);
  /// Appends rows of NaN: pixels that an interrupted session never reached.
  void write_missing(const PixelRect& rect);
  /// Completes the files and the report's figures.
  void finish(RenderReport& report);

 private:
  void add_row(const SpectralFilm& film, uint32_t y);
  /// pixel: its place in the rows since the last flush
  void add_pixel(uint64_t samples, const float* film_mean, const float* film_variance, std::size_t pixel);
  void add_aux(std::span<const AuxiliaryPixel> pixels);
  void flush_strip();
  void wait_for_writing();

  struct Rows {
    std::vector<float> mean, variance, aux;  // [row][x][band or plane]
  };

  const BandSelection bands_;
  std::vector<double> scale_;  // per film channel
  SessionSettings settings_;
  uint32_t width_, height_, strip_;
  std::vector<std::unique_ptr<CubeWriter>> writers_;
  std::vector<std::vector<std::unique_ptr<CubeWriter>>> replicate_writers_;  // [replicate][output]
  std::vector<std::string> aux_names_;
  Rows rows_in_work_, rows_being_written_;
  std::vector<float> film_mean_, film_variance_;  // one row of the film
  uint32_t first_row_ = 0, rows_ = 0;
  std::vector<std::array<float, 3>> preview_weights_;
  std::vector<float> preview_;
  BandScale band_scale_;
  std::vector<double> exact_mean_, exact_variance_;  // one pixel
  ErrorSums errors_;
  RangeLosses losses_;
  uint64_t missing_ = 0, least_ = ~0ull, most_ = 0;
  std::vector<std::filesystem::path> files_;
  std::future<void> writing_;  // last, so that it is waited for before anything that it uses goes
};

/// Names of the planes of an auxiliary image: "normal" gives normal.X, normal.Y, normal.Z.
std::vector<std::string> auxiliary_planes(const std::vector<std::string>& images);

}  // namespace kiloband
