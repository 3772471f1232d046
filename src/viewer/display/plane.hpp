// What is made of an image's channels before it is shown: one value per pixel, or a linear RGB colour.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband::viewer {

class PixelSource;

/// Per band, for red, green and blue; of bands' integrals.
using RgbWeights = std::vector<std::array<float, 3>>;

/// Sums of products with three sets of weights at once (three_sums.hpp).
class ThreeSums {
 public:
  ThreeSums(const PixelSource& source, const RgbWeights& of_integrals);
  /// values: of a pixel, in the source's units; those of bands without weight may be NaN or infinite
  void operator()(const float* values, float* out) const;
  bool operator==(const ThreeSums&) const = default;

 private:
  std::array<std::vector<float>, 3> weights_;  // [component][band], times the unit
};

/// An image whose pixels are read row by row. Values are in units of the source: band k times unit(k) is its integral.
class PixelSource {
 public:
  virtual ~PixelSource() = default;
  virtual uint32_t width() const = 0;
  virtual uint32_t height() const = 0;
  virtual const std::vector<Band>& bands() const = 0;
  /// W m^-2 sr^-1 of a value of 1, per band (of derived bands their own unit).
  virtual const std::vector<double>& units() const = 0;
  /// Means of row y, [x][band]; NaN where a pixel has no sample. Thread-safe.
  virtual void means(uint32_t y, std::span<float> out) const = 0;
  /// Means of one band in row y, [x]. row: memory that the caller keeps for the next. Thread-safe.
  virtual void band_means(uint32_t y, std::size_t band, std::span<float> out, std::vector<float>& row) const;
  /// Whether variances() has any but NaN.
  virtual bool has_variances() const = 0;
  /// Variances of the means, [x][band]; NaN where they are not known. Thread-safe.
  virtual void variances(uint32_t y, std::span<float> out) const = 0;
  /// That stand behind each variance at least: one more than its degrees of freedom; 0: not known.
  virtual uint32_t replicates() const { return 0; }
  /// Whether pixels' errors are known to have nothing to do with each other, so that those of means of pixels follow.
  virtual bool has_independent_errors() const { return false; }
  /// The sums of all pixels of row y, [x][3]. Thread-safe for different rows, once prepare() was called with the same.
  virtual void sums(uint32_t y, const ThreeSums& of_row, std::span<float> out) const;
  /// For sources that keep something for the next time.
  virtual void prepare(const ThreeSums&) const {}
};

/// [y][x][component], 1 or 3 components; NaN: no sample.
struct Plane {
  uint32_t width = 0, height = 0, components = 1;
  std::vector<float> values;
};

/// One band: a channel's density, W m^-2 sr^-1 nm^-1, a derived band as it is.
struct ChannelOf {
  std::size_t band = 0;
};
/// The same in kelvin: the brightness temperature of a channel.
struct TemperatureOf {
  std::size_t band = 0;
};
/// The standard error of the sum over the channels (every channel's own, added: an upper bound, reached where the
/// channels' errors go together, as they do along a path), divided by that sum; of the channels whose variance is known.
struct RelativeError {};

/// threads: among how many rows are dealt, at least 1
Plane weighted_plane(const PixelSource& source, const RgbWeights& weights, unsigned threads);
Plane channel_plane(const PixelSource& source, const ChannelOf& channel, unsigned threads);
Plane temperature_plane(const PixelSource& source, const TemperatureOf& channel, unsigned threads);
Plane error_plane(const PixelSource& source, unsigned threads);

/// "400-410 nm", for messages.
std::string band_range_text(const Channel& range);

/// Means over the channels that overlap three ranges, weighted by the overlap, of densities; red first.
/// throws InputError  a range that no channel overlaps
RgbWeights range_weights(const std::vector<Band>& bands, const std::array<Channel, 3>& ranges);

/// The p-th quantile (0 to 1) of the finite values, estimated from at most 2^16 of them, evenly spread;
/// `fallback` where there is none.
float quantile(const Plane& plane, double p, float fallback);

}  // namespace kiloband::viewer
