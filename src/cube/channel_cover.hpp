// How many channels cover a wavelength: what several have in common counts once.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "spectral/channels.hpp"

namespace kiloband {

/// Where the number of channels that cover a wavelength changes, and that number in the interval
/// that begins there.
class ChannelCover {
 public:
  explicit ChannelCover(const ChannelList& channels) {
    std::vector<std::pair<double, int>> steps;
    for (const Channel& c : channels) {
      steps.emplace_back(c.min_nm, 1);
      steps.emplace_back(c.max_nm, -1);
    }
    std::sort(steps.begin(), steps.end());
    int count = 0;
    for (const auto& [nm, step] : steps) {
      count += step;
      if (!edges_.empty() && edges_.back() == nm) {
        counts_.back() = count;
      } else {
        edges_.push_back(nm);
        counts_.push_back(count);
      }
    }
  }

  /// action(from_nm, to_nm, count) for the pieces of [min_nm, max_nm], which lies inside the cover.
  template <class Action>
  void for_pieces(double min_nm, double max_nm, Action action) const {
    auto i =
        static_cast<std::size_t>(std::upper_bound(edges_.begin(), edges_.end(), min_nm) - edges_.begin());
    for (double from = min_nm; from < max_nm; ++i) {
      const double to = i < edges_.size() ? std::min(edges_[i], max_nm) : max_nm;
      if (from < to) action(from, to, i > 0 ? counts_[i - 1] : 0);
      from = to;
    }
  }

 private:
  std::vector<double> edges_;
  std::vector<int> counts_;
};

}  // namespace kiloband
