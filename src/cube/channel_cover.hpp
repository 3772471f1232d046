// Which part of a wavelength is each channel's that covers it: what several have in common counts once.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "spectral/channel_density.hpp"

namespace kiloband {

/// The pieces between edges of channels, and the channels' shares of them.
class ChannelCover {
 public:
  explicit ChannelCover(const ChannelList& channels) : density_(channels) {
    const std::vector<double>& edges = density_.edges_nm();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (density_[i] == 0) continue;
      if (i == 0 || density_[i - 1] == 0) covered_nm_.emplace_back(edges[i], edges[i]);
      covered_nm_.back().second = edges[i + 1];
    }
  }

  /// What the channels cover: intervals in ascending order that do not touch.
  const std::vector<std::pair<double, double>>& covered_nm() const { return covered_nm_; }

  /// action(from_nm, to_nm, share) for the pieces of one of the channels: its part of what lies there, from 0 to 1. The narrower a channel, the more of its
  /// light comes from there, so that shares go by 1 / width as those of responses that are rendered (DerivedChannels).
  template <class Action>
  void for_shares(const Channel& channel, Action action) const {
    for_pieces(channel.min_nm, channel.max_nm, [&](double from, double to, double density) {
      action(from, to, 1 / channel_divisor(channel, density));
    });
  }

 private:
  /// action(from_nm, to_nm, density) for the pieces of [min_nm, max_nm]; 0 where no channel is.
  template <class Action>
  void for_pieces(double min_nm, double max_nm, Action action) const {
    const std::vector<double>& edges = density_.edges_nm();
    auto i = static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), min_nm) - edges.begin());
    for (double from = min_nm; from < max_nm; ++i) {
      const double to = i < edges.size() ? std::min(edges[i], max_nm) : max_nm;
      if (from < to) action(from, to, i > 0 ? density_[i - 1] : 0.0);
      from = to;
    }
  }

  ChannelDensity density_;
  std::vector<std::pair<double, double>> covered_nm_;
};

}  // namespace kiloband
