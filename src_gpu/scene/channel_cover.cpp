#include "src_gpu/scene/channel_cover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "spectral/channel_density.hpp"

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

/// The edges inside a channel, [first, second).
std::pair<std::size_t, std::size_t> edges_inside(const ChannelDensity& density, const Channel& c) {
  const std::vector<double>& edges = density.edges_nm();
  const auto place = [&](auto at) { return static_cast<std::size_t>(at - edges.begin()); };
  return {place(std::ranges::upper_bound(edges, c.min_nm)), place(std::ranges::lower_bound(edges, c.max_nm))};
}

}  // namespace

ChannelCover make_channel_cover(const ChannelList& channels, std::size_t max_bytes) {
  const ChannelDensity density(channels);
  ChannelCover result;
  result.overlapping = density.overlapping();
  if (!result.overlapping) return result;
  for (const Channel& c : channels) {
    const auto divisor_from = [&](std::size_t i) {
      return static_cast<float>(channel_divisor(c, density[i]));
    };
    const auto inside = edges_inside(density, c);
    float divisor = divisor_from(inside.first - 1);
    result.cover.push_back({static_cast<kb_u32>(result.breaks.size()), divisor});
    for (std::size_t i = inside.first; i < inside.second; ++i) {
      if (divisor_from(i) == divisor) continue;
      divisor = divisor_from(i);
      result.breaks.push_back({first_mu(c, density.edges_nm()[i]), divisor});
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
