// Which part of a wavelength is each channel's that covers it: what several have in common counts once.
#pragma once

#include <algorithm>
#include <vector>

#include "spectral/channels.hpp"

namespace kiloband {

/// Where the density of channels changes: the sum of 1 / width of those that cover a wavelength, 1/nm.
class ChannelCover {
 public:
  explicit ChannelCover(const ChannelList& channels) {
    for (const Channel& c : channels) edges_.insert(edges_.end(), {c.min_nm, c.max_nm});
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    density_.assign(edges_.size(), 0.0);
    const auto place = [&](double edge_nm) {
      return static_cast<std::size_t>(std::lower_bound(edges_.begin(), edges_.end(), edge_nm) -
                                      edges_.begin());
    };
    for (const Channel& c : channels)
      for (std::size_t i = place(c.min_nm); i < place(c.max_nm); ++i) density_[i] += 1 / c.width_nm();
  }

  /// action(from_nm, to_nm, density) for the pieces of [min_nm, max_nm]; 0 where no channel is.
  template <class Action>
  void for_pieces(double min_nm, double max_nm, Action action) const {
    auto i =
        static_cast<std::size_t>(std::upper_bound(edges_.begin(), edges_.end(), min_nm) - edges_.begin());
    for (double from = min_nm; from < max_nm; ++i) {
      const double to = i < edges_.size() ? std::min(edges_[i], max_nm) : max_nm;
      if (from < to) action(from, to, i > 0 ? density_[i - 1] : 0.0);
      from = to;
    }
  }

  /// action(from_nm, to_nm, share) for the pieces of one of the channels: its part of what lies there, from 0 to 1. The narrower a channel, the more of its
  /// light comes from there, so that shares go by 1 / width as those of responses that are rendered (DerivedChannels).
  template <class Action>
  void for_shares(const Channel& channel, Action action) const {
    for_pieces(channel.min_nm, channel.max_nm, [&](double from, double to, double density) {
      action(from, to, 1 / std::max(1.0, channel.width_nm() * density));
    });
  }

 private:
  std::vector<double> edges_;
  std::vector<double> density_;
};

}  // namespace kiloband
