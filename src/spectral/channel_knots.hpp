// A function of the wavelength offset mu in each channel, piecewise linear between knots: absorption
// coefficients, whose lines may be thousands to a channel. Unlike a regular table it is exact between the
// lines too, where a long path has its windows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Knots of channel k: [first[k], first[k + 1]), at least 2, mu ascending from 0 to 1. Where two knots have
/// the same mu the value jumps, and at that mu it is the second one's.
struct ChannelKnots {
  std::vector<uint32_t> first;  // K + 1
  std::vector<double> mu, value;

  double operator()(std::size_t channel, double at_mu) const;
};

/// The spectrum at lambda = (1 - mu) min + mu max: the very knots of tabulated spectra; of others those of a
/// table with a relative error of 1e-5. name: for messages.
/// throws InputError  more knots than 2^28 in all channels together
ChannelKnots sampled_knots(const Spectrum& spectrum, const ChannelList& channels, const std::string& name);

/// The same values in ascending order: mu is the fraction of the channel where the value is smaller.
/// Integrals over mu of a function of the value alone are the same, and smooth integrands. The order is exact;
/// knots are then left out where the value stays within 3e-4 of it, plus 1e-9 of the channel's largest: so an
/// absorptance 1 - exp(-kappa x) is right to 3e-4 of it, exp(-kappa x) to 1.1e-4.
ChannelKnots sorted_knots(const ChannelKnots& sampled);

}  // namespace kiloband
