#include "spectral/channel_density.hpp"

#include <algorithm>
#include <cstdint>

namespace kiloband {

ChannelDensity::ChannelDensity(const ChannelList& channels) {
  for (const Channel& c : channels) edges_nm_.insert(edges_nm_.end(), {c.min_nm, c.max_nm});
  std::sort(edges_nm_.begin(), edges_nm_.end());
  edges_nm_.erase(std::unique(edges_nm_.begin(), edges_nm_.end()), edges_nm_.end());
  density_.assign(edges_nm_.size(), 0.0);
  std::vector<uint32_t> covering(edges_nm_.size());
  const auto place = [&](double edge_nm) {
    return static_cast<std::size_t>(std::lower_bound(edges_nm_.begin(), edges_nm_.end(), edge_nm) -
                                    edges_nm_.begin());
  };
  for (const Channel& c : channels) {
    const std::size_t end = place(c.max_nm);
    for (std::size_t i = place(c.min_nm); i < end; ++i) {
      density_[i] += 1 / c.width_nm();
      overlapping_ |= ++covering[i] > 1;
    }
  }
}

double ChannelDensity::at(double lambda_nm) const {
  const auto behind = std::upper_bound(edges_nm_.begin(), edges_nm_.end(), lambda_nm);
  return behind == edges_nm_.begin() ? 0 : density_[static_cast<std::size_t>(behind - edges_nm_.begin()) - 1];
}

double channel_divisor(const Channel& channel, double density) {
  return std::max(1.0, channel.width_nm() * density);
}

}  // namespace kiloband
