// Spectra that are given at the centres of bands (BandSet, flat_scene.hpp): positions, means,
// and as a Spectrum.
#pragma once

#include <span>
#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// value = scale * ((1 - fraction) v[index] + fraction v[index + 1]), or 0 if not inside. index + 1 is a
/// band, unless there is one band only: then index and fraction are 0.
struct BandPosition {
  uint32_t index = 0;
  double fraction = 0;  // in [0, 1]
  bool inside = true;
};
BandPosition band_position(const BandSet& set, double lambda_nm);

/// Adds to out[i] the weight of v[i] in the mean over the channel, without the set's scale; it is > 0 for
/// just those bands that the channel sees.
void add_mean_weights(const BandSet& set, const Channel& channel, std::span<double> out);

/// The spectrum of one texel's values, times the scale.
Spectrum band_spectrum(const BandSet& set, std::span<const double> values);

}  // namespace kiloband
