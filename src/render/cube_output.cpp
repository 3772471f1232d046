#include "render/cube_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cube/cube_text.hpp"
#include "files/file_set.hpp"
#include "post/replicated_cube.hpp"

namespace kiloband {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Rows that are scaled and written together: whole blocks, few enough to be in a cache still when the
/// writers come to them.
uint32_t rows_per_write(uint32_t at_most, std::size_t row_bytes) {
  constexpr std::size_t kBytes = 8u << 20;
  const std::size_t blocks = std::max<std::size_t>(kBytes / (row_bytes * kBlockSize), 1);
  return static_cast<uint32_t>(std::min<std::size_t>(at_most, blocks * kBlockSize));
}

bool is_exr(const std::filesystem::path& file) {
  return lowered_extension(file) == ".exr";
}

}  // namespace

std::vector<std::string> auxiliary_planes(const std::vector<std::string>& images) {
  std::vector<std::string> planes;
  for (const std::string& image : images) {
    if (image == "normal") {
      planes.insert(planes.end(), {"normal.X", "normal.Y", "normal.Z"});
    } else {
      planes.push_back(image);
    }
  }
  return planes;
}

CubeOutput::CubeOutput(const FlatScene& scene, const BandSelection& bands,
                       const std::vector<double>& film_scale, const SessionSettings& settings,
                       uint32_t replicates, uint32_t rows_per_strip)
    : bands_(bands),
      scale_(film_scale),
      settings_(settings),
      width_(scene.film.crop_width),
      height_(scene.film.crop_height),
      strip_(rows_per_write(rows_per_strip, std::size_t{width_} * bands.bands.size() * sizeof(float))),
      aux_names_(auxiliary_planes(settings.aux)),
      band_scale_(bands.film_channels, film_scale),
      exact_mean_(bands.bands.size()),
      exact_variance_(bands.bands.size()),
      errors_(bands.bands.size()) {
  CubeInfo info;
  info.width = width_;
  info.height = height_;
  info.bands = bands.bands;
  info.variance = settings.variance;
  info.replicates = replicates;
  info.aux = aux_names_;
  info.metadata = settings.metadata;
  for (const auto& file : settings.outputs) {
    info.quantity = settings.quantity.value_or(is_exr(file) ? Quantity::kDensity : Quantity::kIntegral);
    writers_.push_back(create_cube_writer(file, info, strip_));
    files_.push_back(file);
  }
  if (settings.keep_replicates) {
    CubeInfo one = info;
    one.variance = false;
    one.aux.clear();
    one.replicates = 1;
    replicate_writers_.resize(replicates);
    for (uint32_t r = 0; r < replicates; ++r) {
      for (const auto& file : settings.outputs) {
        one.quantity = settings.quantity.value_or(is_exr(file) ? Quantity::kDensity : Quantity::kIntegral);
        one.metadata["replicate"] = std::to_string(r);
        files_.push_back(replicate_path(file, r));
        replicate_writers_[r].push_back(create_cube_writer(files_.back(), one, strip_));
      }
    }
  }
  if (settings.preview) {
    preview_weights_ = preview_weights(bands.bands);
    preview_.reserve(std::size_t{3} * width_ * height_);
  }
}

void CubeOutput::add_pixel(uint64_t samples, const float* film_mean, const float* film_variance,
                           std::size_t pixel) {
  const std::size_t bands = bands_.bands.size();
  float* const mean = rows_in_work_.mean.data() + pixel * bands;
  least_ = std::min(least_, samples);
  most_ = std::max(most_, samples);
  missing_ += samples == 0;
  if (samples == 0) {
    std::fill_n(mean, bands, kMissing);
  } else {
    band_scale_.means(film_mean, exact_mean_, mean, losses_);
  }
  if (settings_.variance) {
    band_scale_.variances(film_variance, exact_variance_, rows_in_work_.variance.data() + pixel * bands,
                          losses_);
    if (samples > 0) errors_.add(exact_mean_, exact_variance_);
  }
  if (!settings_.preview) return;
  float rgb[3] = {0, 0, 0};
  for (std::size_t b = 0; samples > 0 && b < bands; ++b)
    for (int i = 0; i < 3; ++i) rgb[i] += preview_weights_[b][i] * mean[b];
  preview_.insert(preview_.end(), rgb, rgb + 3);
}

void CubeOutput::add_row(const SpectralFilm& film, uint32_t y) {
  const std::size_t channels = film.options().channels;
  film_mean_.resize(width_ * channels);
  film_variance_.resize(settings_.variance ? width_ * channels : 0);
  film.row(y, film_mean_, film_variance_);
  for (uint32_t x = 0; x < width_; ++x)
    add_pixel(film.samples(x, y), film_mean_.data() + x * channels,
              settings_.variance ? film_variance_.data() + x * channels : nullptr,
              std::size_t{rows_} * width_ + x);
  ++rows_;
}

void CubeOutput::set_counts(const SampleCounts& counts) {
  wait_for_writing();
  for (auto& writer : writers_) writer->set_counts(counts);
  for (std::size_t r = 0; r < replicate_writers_.size(); ++r)
    for (auto& writer : replicate_writers_[r]) writer->set_counts({counts.replicate_samples.at(r), 1, {}});
}

void CubeOutput::add_aux(std::span<const AuxiliaryPixel> pixels) {
  for (const AuxiliaryPixel& pixel : pixels) {
    for (const std::string& image : settings_.aux) {
      if (image == "depth") rows_in_work_.aux.push_back(pixel.depth);
      if (image == "normal")
        rows_in_work_.aux.insert(rows_in_work_.aux.end(), {pixel.normal.x, pixel.normal.y, pixel.normal.z});
      if (image == "object") rows_in_work_.aux.push_back(pixel.object);
      if (image == "material") rows_in_work_.aux.push_back(pixel.material);
    }
  }
}

void CubeOutput::write(const SpectralFilm& film, uint32_t y, uint32_t rows,
                       std::span<const AuxiliaryPixel> auxiliary) {
  const std::size_t values = std::size_t{rows} * width_ * bands_.bands.size();
  rows_in_work_.mean.resize(values);
  rows_in_work_.variance.resize(settings_.variance ? values : 0);
  for (uint32_t i = 0; i < rows; ++i) add_row(film, y + i);
  add_aux(auxiliary);
  flush_strip();
}

void CubeOutput::write_missing(const PixelRect& rect) {
  const std::size_t bands = bands_.bands.size();
  for (uint32_t y = 0; y < rect.height; y += strip_) {
    rows_ = std::min(strip_, rect.height - y);
    const std::size_t pixels = std::size_t{rows_} * width_;
    missing_ += pixels;
    least_ = 0;
    rows_in_work_.mean.assign(pixels * bands, kMissing);
    if (settings_.variance) rows_in_work_.variance.assign(pixels * bands, kMissing);
    rows_in_work_.aux.assign(pixels * aux_names_.size(), kMissing);
    if (settings_.preview) preview_.resize(preview_.size() + 3 * pixels);
    for (auto& replicate : replicate_writers_) {
      for (auto& writer : replicate) writer->write_rows({first_row_, rows_, rows_in_work_.mean, {}, {}});
    }
    flush_strip();
  }
}

/// Rows are written while the next ones are made; where there may be no further thread, before that.
void CubeOutput::flush_strip() {
  wait_for_writing();
  std::swap(rows_in_work_, rows_being_written_);
  rows_in_work_.aux.clear();
  writing_ = std::async(std::launch::async | std::launch::deferred, [this, y0 = first_row_, rows = rows_] {
    const auto& [mean, variance, aux] = rows_being_written_;
    for (auto& writer : writers_) writer->write_rows({y0, rows, mean, variance, aux});
  });
  first_row_ += rows_;
  rows_ = 0;
}

void CubeOutput::wait_for_writing() {
  if (writing_.valid()) writing_.get();
}

void CubeOutput::write_replicates(const SpectralFilm& film) {
  const PixelRect& rect = film.rect();
  const uint32_t image_row = first_row_ - rect.height;
  std::vector<float> rows, mean(film.options().channels);
  for (uint32_t r = 0; r < replicate_writers_.size(); ++r) {
    for (uint32_t y = 0; y < rect.height; y += strip_) {
      const uint32_t count = std::min(strip_, rect.height - y);
      rows.clear();
      for (std::size_t pixel = std::size_t{y} * width_; pixel < std::size_t{y + count} * width_; ++pixel) {
        film.replicate_mean(r, pixel, mean);
        const bool empty = film.replicate_samples(r, pixel) == 0;
        for (const std::size_t c : bands_.film_channels) {
          rows.push_back(empty ? kMissing : static_cast<float>(mean[c] * scale_[c]));
          losses_.overflowed += !empty && !std::isfinite(rows.back());
        }
      }
      for (auto& writer : replicate_writers_[r]) writer->write_rows({image_row + y, count, rows, {}, {}});
    }
  }
}

void CubeOutput::finish(RenderReport& report) {
  wait_for_writing();
  FileSet set;  // the mean of one render must not stand beside the replicates of another
  const auto close = [&](CubeWriter& writer) {
    writer.close(set);
    losses_.overflowed += writer.overflowed_values();
    losses_.overflowed_variances += writer.overflowed_variances();
  };
  for (auto& replicate : replicate_writers_) {
    for (auto& writer : replicate) close(*writer);
  }
  for (auto& writer : writers_) close(*writer);
  set.commit();
  if (settings_.preview) {
    const float exposure = auto_exposure(preview_);
    for (float& value : preview_) value *= exposure;
    write_png(*settings_.preview, width_, height_, preview_);
    files_.push_back(*settings_.preview);
  }
  report.samples_per_pixel = least_ == ~0ull ? 0 : least_;
  report.largest_samples_per_pixel = most_;
  report.pixels_without_sample = missing_;
  report.underflowed_values = losses_.underflowed;
  report.underflowed_variances = losses_.underflowed_variances;
  report.overflowed_values = losses_.overflowed;
  report.overflowed_variances = losses_.overflowed_variances;
  if (settings_.variance) report.errors = errors_.errors();
  report.written = files_;
}

}  // namespace kiloband
