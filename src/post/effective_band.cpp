#include "post/effective_band.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cube/cube_layout.hpp"
#include "spectral/quadrature.hpp"

namespace kiloband {
namespace {

constexpr double kTolerance = 1e-9;  // relative, of the integrals

/// What the channels cover: intervals in ascending order that do not touch.
std::vector<std::pair<double, double>> covered(ChannelList channels) {
  std::ranges::sort(channels, {}, &Channel::min_nm);
  std::vector<std::pair<double, double>> pieces;
  for (const Channel& c : channels) {
    if (pieces.empty() || c.min_nm > pieces.back().second) {
      pieces.emplace_back(c.min_nm, c.max_nm);
    } else {
      pieces.back().second = std::max(pieces.back().second, c.max_nm);
    }
  }
  return pieces;
}

/// A piece with the response's knots inside, between which it is smooth.
std::vector<double> breaks_of(const Spectrum& response, const std::pair<double, double>& piece) {
  std::vector<double> breaks{piece.first};
  const auto inside = [&](double nm) { return nm > piece.first && nm < piece.second; };
  std::ranges::copy_if(response.knots_nm(), std::back_inserter(breaks), inside);
  breaks.push_back(piece.second);
  return breaks;
}

}  // namespace

double absolute_integral(const Spectrum& response, double min_nm, double max_nm) {
  return integrate([&](double nm) { return std::abs(response(nm)); }, breaks_of(response, {min_nm, max_nm}),
                   kTolerance);
}

Channel effective_band(const Spectrum& response, const ChannelList& channels) {
  double integral = 0, moment = 0, largest = 0;
  for (const auto& piece : covered(channels)) {
    const std::vector<double> breaks = breaks_of(response, piece);
    integral += absolute_integral(response, piece.first, piece.second);
    moment += integrate([&](double nm) { return nm * std::abs(response(nm)); }, breaks, kTolerance);
    largest = std::max({largest, std::abs(response.max_over(piece.first, piece.second)),
                        std::abs(response.min_over(piece.first, piece.second))});
  }
  if (!(integral > 0)) return {hull(channels).min_nm, hull(channels).max_nm, ""};
  const double centre = moment / integral, half = 0.5 * integral / largest;
  // The edges of a box come back as they were given.
  return {without_roundings(centre - half), without_roundings(centre + half), ""};
}

}  // namespace kiloband
