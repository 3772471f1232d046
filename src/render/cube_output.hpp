// Film rows to files: scales film values to W m^-2 sr^-1, feeds all writers and the preview, gathers the
// error figure.
#pragma once

#include <memory>
#include <vector>

#include "render/error_sums.hpp"
#include "render/session.hpp"

namespace kiloband {

class CubeOutput {
 public:
  /// rows_per_strip as create_cube_writer(); film_scale per film channel; samples_per_pixel is stated in the
  /// files
  CubeOutput(const FlatScene& scene, const BandSelection& bands, const std::vector<double>& film_scale,
             const SessionSettings& settings, uint32_t replicates, uint64_t samples_per_pixel,
             uint32_t rows_per_strip);

  /// Appends all rows of a film that covers the next rows of the image.
  void write(const SpectralFilm& film, Backend& backend);
  /// Appends rows of NaN: pixels that an interrupted session never reached.
  void write_missing(const PixelRect& rect);
  /// Completes the files and the report's figures.
  void finish(RenderReport& report);

 private:
  void add_row(const SpectralFilm& film, uint32_t y);
  void add_aux(Backend& backend, const PixelRect& rect);
  void flush_strip();
  void write_replicates(const SpectralFilm& film);
  float scaled(float value, double scale);
  float scaled_variance(float value, double scale);

  const BandSelection bands_;
  std::vector<double> scale_;  // per film channel
  SessionSettings settings_;
  uint32_t width_, height_, strip_;
  std::vector<std::unique_ptr<CubeWriter>> writers_;
  std::vector<std::vector<std::unique_ptr<CubeWriter>>> replicate_writers_;  // [replicate][output]
  std::vector<std::string> aux_names_;
  std::vector<float> mean_, variance_, aux_;      // rows since the last flush
  std::vector<float> film_mean_, film_variance_;  // one row of the film
  uint32_t first_row_ = 0, rows_ = 0;
  std::vector<std::array<float, 3>> preview_weights_;
  std::vector<float> preview_;
  ErrorSums errors_;
  uint64_t missing_ = 0, least_ = ~0ull, most_ = 0, underflowed_ = 0, overflowed_ = 0,
           overflowed_variances_ = 0;
  std::vector<std::filesystem::path> files_;
};

/// Names of the planes of an auxiliary image: "normal" gives normal.X, normal.Y, normal.Z.
std::vector<std::string> auxiliary_planes(const std::vector<std::string>& images);

}  // namespace kiloband
