#include "src_gpu/scene/channel_cover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace kiloband::opencl {
namespace {

/// The smallest float mu in [0, 1] at which the channel's wavelength reaches the edge. Floats that are not
/// negative are ordered as their bits.
float first_mu(const Channel& c, double edge_nm) {
  kb_u32 low = 0, high = kb_as_u32(1.0f);
  while (low < high) {
    const kb_u32 middle = low + (high - low) / 2;
    const double mu = kb_as_f32(middle);
    if ((1 - mu) * c.min_nm + mu * c.max_nm >= edge_nm)
      high = middle;
    else
      low = middle + 1;
  }
  return kb_as_f32(low);
}

/// All edges, ascending, and what channels that cover a wavelength come to: the sum of 1 / width. In time that grows with the pieces
/// of all channels.
class Edges {
 public:
  explicit Edges(const ChannelList& channels) {
    for (const Channel& c : channels) all_.insert(all_.end(), {c.min_nm, c.max_nm});
    std::ranges::sort(all_);
    all_.erase(std::unique(all_.begin(), all_.end()), all_.end());
    density_.assign(all_.size(), 0.0);
    std::vector<kb_u32> covering(all_.size());
    for (const Channel& c : channels) {
      const auto [second, end] = inside(c);
      for (std::size_t i = second - 1; i < end; ++i) {
        density_[i] += 1 / c.width_nm();
        overlap_ |= ++covering[i] > 1;
      }
    }
  }
  bool overlap() const { return overlap_; }
  /// The edges inside a channel.
  std::pair<std::size_t, std::size_t> inside(const Channel& c) const {
    const auto place = [&](auto at) { return static_cast<std::size_t>(at - all_.begin()); };
    return {place(std::ranges::upper_bound(all_, c.min_nm)), place(std::ranges::lower_bound(all_, c.max_nm))};
  }
  double edge_nm(std::size_t i) const { return all_[i]; }
  /// What a channel's part is divided by from edge i to the next.
  float divisor(const Channel& c, std::size_t i) const {
    return static_cast<float>(std::max(1.0, c.width_nm() * density_[i]));
  }

 private:
  std::vector<double> all_, density_;
  bool overlap_ = false;
};

}  // namespace

ChannelCover make_channel_cover(const ChannelList& channels, std::size_t max_bytes) {
  const Edges edges(channels);
  ChannelCover result;
  result.overlapping = edges.overlap();
  if (!result.overlapping) return result;
  for (const Channel& c : channels) {
    const auto inside = edges.inside(c);
    float divisor = edges.divisor(c, inside.first - 1);
    result.cover.push_back({static_cast<kb_u32>(result.breaks.size()), divisor});
    for (std::size_t i = inside.first; i < inside.second; ++i) {
      if (edges.divisor(c, i) == divisor) continue;
      divisor = edges.divisor(c, i);
      result.breaks.push_back({first_mu(c, edges.edge_nm(i)), divisor});
      if (result.breaks.size() * sizeof(KbCoverBreak) > max_bytes) {
        throw InputError(fmt::format(
            "channels: {} channels overlap so much that what they share of each wavelength takes more than "
            "{} bytes; sensor responses of them can be applied after rendering (kiloband sensor)",
            channels.size(), max_bytes));
      }
    }
  }
  result.cover.push_back({static_cast<kb_u32>(result.breaks.size()), 1.0f});
  return result;
}

}  // namespace kiloband::opencl
