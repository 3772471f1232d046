// How densely channels cover wavelengths: what several have in common is theirs in the ratio of 1 / width (DerivedChannels).
#pragma once

#include <cstddef>
#include <vector>

#include "spectral/channels.hpp"

namespace kiloband {

/// The sum of 1 / width of the channels that cover a wavelength (min_nm <= lambda < max_nm), 1/nm. In time that grows with the pieces of
/// all channels.
class ChannelDensity {
 public:
  explicit ChannelDensity(const ChannelList& channels);

  /// Whether two channels cover a wavelength.
  bool overlapping() const { return overlapping_; }
  /// Where the density may change, ascending.
  const std::vector<double>& edges_nm() const { return edges_nm_; }
  /// From edge i to the next; behind the last 0.
  double operator[](std::size_t i) const { return density_[i]; }
  /// 0 where no channel is.
  double at(double lambda_nm) const;

 private:
  std::vector<double> edges_nm_, density_;
  bool overlapping_ = false;
};

/// What a channel's part of such a wavelength is divided by, at least 1: 1 / share.
double channel_divisor(const Channel& channel, double density);

}  // namespace kiloband
