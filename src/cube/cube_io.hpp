// Spectral cubes on disk: EXR (Fichet et al. 2021) and ENVI; docs/output_formats.md says what is written.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"
#include "spectral/channels.hpp"

namespace kiloband {

class FileSet;

/// Integral: W m^-2 sr^-1 over the band. Density: its mean, W m^-2 sr^-1 nm^-1 (value / width).
enum class Quantity { kIntegral, kDensity };

/// One band of a cube. A derived band (a sensor response) has a name and no width
/// that values could be divided by.
struct Band {
  Channel channel;       // interval in nm; name may be empty
  bool derived = false;  // always written as it is, whatever the quantity
};

struct CubeInfo {
  uint32_t width = 0, height = 0;
  std::vector<Band> bands;
  bool variance = false;         // the variance of the mean accompanies every band
  bool holds_variances = false;  // the values themselves are variances of another cube's means (X.var.hdr)
  Quantity quantity = Quantity::kIntegral;  // of the values on disk
  uint64_t samples_per_pixel = 0;           // of every pixel at least; 0: not known, or some pixel has none
  uint32_t replicates = 0;  // that stand behind each variance at least: one more than its degrees of freedom
  /// Of each replicate whose cube stands beside this one (--keep-replicates), in every pixel that it has reached at least; empty: not stated.
  std::vector<uint64_t> replicate_samples;
  std::vector<std::string> aux;                 // names of auxiliary float planes ("depth", "normal.X" ...)
  std::map<std::string, std::string> metadata;  // written as they are (seed, method, program version ...)
};

/// Values of some full rows: [row][x][band] for mean and variance, [row][x][aux plane] for aux. Channel
/// values (integrals) always; writers convert to the file's quantity (variance by width squared).
struct CubeRows {
  uint32_t y0 = 0, rows = 0;
  std::span<const float> mean, variance, aux;
};

/// What a cube states of its samples: CubeInfo has the meanings.
struct SampleCounts {
  uint64_t samples_per_pixel = 0;
  uint32_t replicates = 0;
  std::vector<uint64_t> replicate_samples;
};

/// Writes a cube strip by strip in ascending order. Nothing stands under the final names before finish():
/// files are written beside, flushed and renamed, the ENVI data before its header, all of them as one
/// (FileSet). A destroyed writer that was not finished leaves nothing behind.
class CubeWriter {
 public:
  virtual ~CubeWriter() = default;
  /// Instead of CubeInfo's, for who opens a file before knowing: before the first write_rows(), and once more before close() where it
  /// comes to less than was expected (no number larger than before).
  virtual void set_counts(const SampleCounts& counts) = 0;
  virtual void write_rows(const CubeRows& rows) = 0;
  /// All rows have come: completes the data and adds the cube's files to the set, which several cubes may
  /// share. The writer must outlive the set's commit().
  virtual void close(FileSet& files) = 0;
  /// close(), and the commit() of a set of this cube alone.
  void finish();
  /// Finite values (variances) that the change of quantity made infinite.
  virtual uint64_t overflowed_values() const = 0;
  virtual uint64_t overflowed_variances() const = 0;
};

/// throws InputError if create_cube_writer() does not know the extension
void check_cube_name(const std::filesystem::path& file);

/// What open_cube() of this name reads, as far as it is there: header, data and parts of an ENVI cube, links as given and the files behind
/// them. Other files are themselves alone.
std::vector<std::filesystem::path> cube_files(const std::filesystem::path& file);
/// What a writer of this name writes, or removes if an earlier cube has left it.
std::vector<std::filesystem::path> cube_output_files(const std::filesystem::path& file);

/// For what converts, sums or weighs values: variances follow other rules.
/// throws InputError  the cube's values are variances; names the cube that they belong to
void check_holds_radiances(const std::filesystem::path& file, const CubeInfo& info);

/// By extension: .exr, .hdr (ENVI: X.hdr + X.img, with variance X.var.hdr + X.var.img,
/// aux planes X.aux.hdr + X.aux.img).
/// rows_per_strip  rows that each write_rows call will have (the last may have fewer); a multiple of 32 or
///                 the height
/// throws InputError   the extension
///        DeviceError  cannot create, disk full ...: names the file and the system's message
std::unique_ptr<CubeWriter> create_cube_writer(const std::filesystem::path& file, const CubeInfo& info,
                                               uint32_t rows_per_strip);

/// Reads back what the writers wrote, and cubes of others as far as the layouts are followed. Values come
/// back as they are on disk (info().quantity says what that is);
/// incomplete or damaged files are an InputError.
class CubeReader {
 public:
  virtual ~CubeReader() = default;
  virtual const CubeInfo& info() const = 0;
  /// mean and variance: [row][x][band] for rows y0 .. y0 + rows - 1; variance may be empty (not wanted).
  virtual void read_rows(uint32_t y0, uint32_t rows, std::span<float> mean, std::span<float> variance) = 0;
  /// [row][x][aux plane]
  virtual void read_aux(uint32_t y0, uint32_t rows, std::span<float> aux) = 0;
  /// Numbers per pixel of the rows that are asked for that reading holds, the caller's among them: how many rows fit into memory.
  virtual std::size_t floats_held() const;
};

/// file: .exr, .hdr or .img
std::unique_ptr<CubeReader> open_cube(const std::filesystem::path& file, const DiagnosticSink& sink = {});

/// Names of bands that are unique: equal centres get the suffix "_2", "_3" ... in band order.
std::vector<std::string> unique_band_names(const std::vector<Band>& bands);

/// 8-bit sRGB PNG of linear RGB [y][x][3], exposure applied by the caller; atomic as above.
void write_png(const std::filesystem::path& file, uint32_t width, uint32_t height,
               std::span<const float> linear_rgb);

/// Weights [band][3] that turn band values (integrals) of a cube into a linear sRGB preview: colour matching
/// functions where the bands reach into 380-780 nm, false colour (three equal thirds of the range) otherwise.
/// Exposure is left to auto_exposure().
std::vector<std::array<float, 3>> preview_weights(const std::vector<Band>& bands);
/// False colour whatever the wavelengths.
/// throws InputError  all bands are derived
std::vector<std::array<float, 3>> false_colour_weights(const std::vector<Band>& bands);
/// Whether a channel reaches into 380-780 nm.
bool shows_visible_light(const std::vector<Band>& bands);
/// Scale that maps the 99th percentile of the pixels' largest component to 1 (1 for black images).
float auto_exposure(std::span<const float> linear_rgb);

}  // namespace kiloband
