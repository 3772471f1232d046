#include "src_gpu/scene/channel_cover.hpp"

#include <fmt/format.h>

#include <algorithm>

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

/// All edges, ascending.
struct Edges {
  std::vector<double> min, max, all;

  explicit Edges(const ChannelList& channels) {
    for (const Channel& c : channels) {
      min.push_back(c.min_nm);
      max.push_back(c.max_nm);
    }
    std::ranges::sort(min);
    std::ranges::sort(max);
    std::ranges::set_union(min, max, std::back_inserter(all));
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
  bool overlap() const {
    for (std::size_t k = 1; k < min.size(); ++k)
      if (min[k] < max[k - 1]) return true;
    return false;
  }
  kb_u32 cover(double lambda_nm) const {
    const auto up_to = [&](const std::vector<double>& edges) {
      return std::ranges::upper_bound(edges, lambda_nm) - edges.begin();
    };
    return static_cast<kb_u32>(std::max<std::ptrdiff_t>(1, up_to(min) - up_to(max)));
  }
};

}  // namespace

ChannelCover make_channel_cover(const ChannelList& channels, std::size_t max_bytes) {
  const Edges edges(channels);
  ChannelCover result;
  result.overlapping = edges.overlap();
  if (!result.overlapping) return result;
  for (const Channel& c : channels) {
    kb_u32 cover = edges.cover(c.min_nm);
    result.cover.push_back({static_cast<kb_u32>(result.breaks.size()), cover});
    for (auto edge = std::ranges::upper_bound(edges.all, c.min_nm);
         edge != edges.all.end() && *edge < c.max_nm; ++edge) {
      if (edges.cover(*edge) == cover) continue;
      cover = edges.cover(*edge);
      result.breaks.push_back({first_mu(c, *edge), cover});
      if (result.breaks.size() * sizeof(KbCoverBreak) > max_bytes) {
        throw InputError(fmt::format(
            "channels: {} channels overlap so much that counting how many cover a wavelength takes more than "
            "{} bytes; sensor responses of them can be applied after rendering (kiloband sensor)",
            channels.size(), max_bytes));
      }
    }
  }
  result.cover.push_back({static_cast<kb_u32>(result.breaks.size()), 1});
  return result;
}

}  // namespace kiloband::opencl
