#include "post/convert_rebin.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

bool same(double a_nm, double b_nm) {
  return std::abs(a_nm - b_nm) <= edge_tolerance(a_nm);
}
/// The edge lies inside the channel and not on its bounds.
bool cuts(double edge_nm, const Channel& c) {
  return edge_nm > c.min_nm + edge_tolerance(edge_nm) && edge_nm < c.max_nm - edge_tolerance(edge_nm);
}

/// A wavelength that a chain of bands from the coarse channel's lower edge ends at.
struct Node {
  std::size_t previous, band;
};

[[noreturn]] void explain(const std::vector<Band>& bands, const Channel& coarse, const std::string& what) {
  std::string reason = "the channels leave gaps or overlap there";
  for (const double edge : {coarse.max_nm, coarse.min_nm})
    for (std::size_t k = bands.size(); k-- > 0;)
      if (!bands[k].derived && cuts(edge, bands[k].channel))
        reason = "channel " + std::to_string(k) + " (" + band_text(bands[k]) + ") reaches across " +
                 format_short(edge) + " nm";
  throw InputError(what + " (" + band_text({coarse, false}) +
                   ") is not a union of whole channels: " + reason);
}

/// Non-derived bands inside the coarse channel by their lower edges.
std::vector<std::size_t> candidates(const std::vector<Band>& bands, const Channel& coarse) {
  std::vector<std::size_t> inside;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const Channel& c = bands[k].channel;
    const bool begins = c.min_nm >= coarse.min_nm - edge_tolerance(coarse.min_nm);
    if (!bands[k].derived && begins && c.max_nm <= coarse.max_nm + edge_tolerance(coarse.max_nm))
      inside.push_back(k);
  }
  std::stable_sort(inside.begin(), inside.end(), [&](std::size_t a, std::size_t b) {
    return bands[a].channel.min_nm < bands[b].channel.min_nm;
  });
  return inside;
}

}  // namespace

double edge_tolerance(double nm) {
  return 1e-9 * nm;
}

std::vector<std::size_t> bands_of_channel(const std::vector<Band>& bands, const Channel& coarse,
                                          const std::string& what) {
  const auto inside = candidates(bands, coarse);
  for (const std::size_t k : inside)
    if (same(bands[k].channel.min_nm, coarse.min_nm) && same(bands[k].channel.max_nm, coarse.max_nm))
      return {k};
  // Every chain of touching bands from the lower edge, one per wavelength that it reaches.
  std::vector<Node> nodes = {{0, 0}};
  std::map<double, std::size_t> reached = {{coarse.min_nm, 0}};
  const auto find = [&](double nm) {
    const auto at = reached.lower_bound(nm - edge_tolerance(nm));
    return at != reached.end() && same(at->first, nm) ? at : reached.end();
  };
  for (const std::size_t k : inside) {
    const auto from = find(bands[k].channel.min_nm);
    if (from == reached.end() || find(bands[k].channel.max_nm) != reached.end()) continue;
    nodes.push_back({from->second, k});
    reached.emplace(bands[k].channel.max_nm, nodes.size() - 1);
  }
  const auto end = find(coarse.max_nm);
  if (end == reached.end()) explain(bands, coarse, what);
  std::vector<std::size_t> chain;
  for (std::size_t node = end->second; node != 0; node = nodes[node].previous)
    chain.push_back(nodes[node].band);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

}  // namespace kiloband
