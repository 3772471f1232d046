// What the writers and readers of cubes share: limits, checks of a CubeInfo,
// change of quantity, order of strips.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband {

inline constexpr uint32_t kMaxImageEdge = 1u << 20;  // pixels
inline constexpr std::size_t kMaxNameLength = 200;   // bytes; EXR allows 255, prefixes and suffixes need some
inline constexpr std::size_t kMaxAuxPlanes = 1024;
inline constexpr std::string_view kPreviewChannels[] = {"R", "G", "B"};

/// throws InputError  sizes, band intervals and names that no file could hold; messages begin with `where`
void check_cube_info(const CubeInfo& info, const std::string& where);

/// "400-410 nm", or the name of a derived band: for messages.
std::string band_text(const Band& band);

/// The channels of all bands that are not derived.
ChannelList channels_of(const std::vector<Band>& bands);
/// To a billionth: 1000 * 1.005 is a little less than the 1005 that is meant.
double without_roundings(double nm);
/// Empty where the cube has no such entry.
std::string metadata_of(const CubeInfo& info, const std::string& key);

/// Names, in small letters, of what others state of the numbers in their files (ENVI), and we do not apply.
inline constexpr std::string_view kCalibrations[] = {
    "data gain values", "data offset values", "data reflectance gain values",
    "data reflectance offset values", "reflectance scale factor"};

/// Changes values and variances of bands from one quantity to the other; derived bands stay as they are.
class QuantityConversion {
 public:
  QuantityConversion(const std::vector<Band>& bands, Quantity from, Quantity to);

  /// Rounded once: integral -> density is float(value / width).
  float value(std::size_t band, float v) const { return changed(v, width_[band], overflowed_values_); }
  float variance(std::size_t band, float v) const {
    return changed(v, width_[band] * width_[band], overflowed_variances_);
  }
  /// Finite values and variances that became infinite so far.
  uint64_t overflowed_values() const { return overflowed_values_; }
  uint64_t overflowed_variances() const { return overflowed_variances_; }

  /// value() and variance() of `count` bands from `first` on.
  void values(std::size_t first, const float* from, float* to, std::size_t count) const {
    if (same_) return void(std::copy_n(from, count, to));
    for (std::size_t k = 0; k < count; ++k) to[k] = value(first + k, from[k]);
  }
  void variances(std::size_t first, const float* from, float* to, std::size_t count) const {
    if (same_) return void(std::copy_n(from, count, to));
    for (std::size_t k = 0; k < count; ++k) to[k] = variance(first + k, from[k]);
  }

 private:
  float changed(float v, double factor, std::atomic<uint64_t>& overflowed) const {
    const auto result = divide_ ? static_cast<float>(v / factor) : static_cast<float>(v * factor);
    if (std::isinf(result) && !std::isinf(v)) ++overflowed;
    return result;
  }

  mutable std::atomic<uint64_t> overflowed_values_ = 0, overflowed_variances_ = 0;
  bool divide_, same_;
  std::vector<double> width_;  // nm; 1 where nothing changes
};

/// Enforces the contract of CubeWriter::write_rows; breaking it is a std::logic_error.
class StripOrder {
 public:
  StripOrder(const CubeInfo& info, uint32_t rows_per_strip);

  void accept(const CubeRows& strip);
  /// All rows have come and finish() was not called before.
  void finish();

 private:
  uint64_t width_, height_, bands_, aux_;
  bool variance_;
  uint32_t rows_per_strip_;
  uint64_t next_row_ = 0;
  bool finished_ = false;
};

/// Checks the arguments of CubeReader::read_rows and read_aux (planes = 0: buffer not wanted).
/// throws std::logic_error
void check_read(const CubeInfo& info, uint32_t y0, uint32_t rows, std::size_t floats, std::size_t planes);

/// create_cube_writer for rows whose values are given as `given` instead of integrals, so that a copy of a
/// density cube keeps its bits.
std::unique_ptr<CubeWriter> create_cube_writer_from(const std::filesystem::path& file, const CubeInfo& info,
                                                    uint32_t rows_per_strip, Quantity given);

std::unique_ptr<CubeWriter> create_exr_writer(const std::filesystem::path& file, const CubeInfo& info,
                                              uint32_t rows_per_strip, Quantity given);
std::unique_ptr<CubeWriter> create_envi_writer(const std::filesystem::path& file, const CubeInfo& info,
                                               uint32_t rows_per_strip, Quantity given);
/// cube_files() and cube_output_files() of ENVI cubes.
std::vector<std::filesystem::path> envi_files(const std::filesystem::path& file);
std::vector<std::filesystem::path> envi_output_files(const std::filesystem::path& header);
std::unique_ptr<CubeReader> open_exr_cube(const std::filesystem::path& file, const DiagnosticSink& sink);
std::unique_ptr<CubeReader> open_envi_cube(const std::filesystem::path& file, const DiagnosticSink& sink);

/// Where bands have centres only: each reaches to the middle between it and its nearer neighbour, and as far
/// on its other side, so that its centre is the one that was given; a single band is 1 nm wide. Between
/// centres that are not equidistant gaps stay. The order of the centres (nm, distinct) is free.
/// throws InputError  equal centres; the message begins with `where`
ChannelList channels_from_centres(const std::vector<double>& centres_nm, const std::string& where);

}  // namespace kiloband
