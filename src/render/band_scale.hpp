// Film values of a pixel to the bands of an image, in W m^-2 sr^-1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kiloband {

/// What became 0 or infinite when it was stored as float.
struct RangeLosses {
  uint64_t underflowed = 0;  // means above 0 that became 0
  uint64_t underflowed_variances = 0;
  uint64_t overflowed = 0;            // means that are not finite
  uint64_t overflowed_variances = 0;  // infinite; NaN is none: fewer than two replicates have no variance
};

/// Loops over the bands of one pixel, without branches, so that they are vectorised:
/// every value of an image comes by here.
class BandScale {
 public:
  /// film_channels  the film's channel of each band
  /// film_scale     W m^-2 sr^-1 of a film value of 1, per film channel
  BandScale(const std::vector<std::size_t>& film_channels, const std::vector<double>& film_scale);

  /// film is [film channel]; exact and stored are [band]: stored[b] = float(exact[b]).
  void means(const float* film, std::span<double> exact, float* stored, RangeLosses& losses);
  void variances(const float* film, std::span<double> exact, float* stored, RangeLosses& losses);

 private:
  const float* bands_of(const float* film);

  std::vector<std::size_t> channels_;
  std::vector<double> scale_;  // per band
  std::vector<float> picked_;  // one pixel's bands, where they are not the film's channels in order
  bool in_order_ = true;
};

}  // namespace kiloband
