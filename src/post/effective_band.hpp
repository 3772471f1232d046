// The wavelength and the width that a sensor response is stated by.
#pragma once

#include "cube/channel_cover.hpp"
#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Where a response sees light, as an interval without name, nm. Over the wavelengths that channels cover (at
/// least one), its centre is the centroid of |response|, and its width the equivalent width: the integral of
/// |response| over its largest value. A box gives itself, a triangle its width at half maximum about its
/// centroid; the interval never reaches beyond where the response is. The hull of the channels where the
/// response is 0 in all of them.
Channel effective_band(const Spectrum& response, const ChannelCover& cover);

/// Integral of |response| over [min_nm, max_nm], nm times the response's unit; relative error 1e-9.
double absolute_integral(const Spectrum& response, double min_nm, double max_nm);

}  // namespace kiloband
