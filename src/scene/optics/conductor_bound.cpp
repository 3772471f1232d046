#include "scene/optics/conductor_bound.hpp"

#include <algorithm>

#include "scene/optics/facet_quadrature.hpp"

namespace kiloband {
namespace {

/// Index variations inside a channel may carry F a little over its values at the ends and the middle.
constexpr double kSlack = 1.002;

}  // namespace

std::vector<float> make_conductor_bound(const RegularTable& n, const RegularTable& k,
                                        std::initializer_list<const ChannelList*> lists) {
  std::vector<float> bound(KB_CONDUCTOR_CELLS + 1, 0.0f);
  const auto raise = [&](double lambda_nm) {
    for (int i = 0; i <= KB_CONDUCTOR_CELLS; ++i) {
      const double cosine = static_cast<double>(i) / KB_CONDUCTOR_CELLS;
      const double f = 1 - metal_absorptance(cosine, n(lambda_nm), k(lambda_nm));
      // An index of 0 makes 0 / 0 at grazing incidence: everything is reflected there.
      bound[i] = std::max(bound[i], static_cast<float>(f <= 1 ? std::min(1.0, kSlack * f) : 1.0));
    }
  };
  for (const ChannelList* list : lists)
    for (const Channel& channel : *list)
      for (const double lambda_nm : {channel.min_nm, channel.centre_nm(), channel.max_nm}) raise(lambda_nm);
  return bound;
}

}  // namespace kiloband
