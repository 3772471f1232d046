#include "post/effective_band.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cube/channel_cover.hpp"
#include "cube/cube_layout.hpp"
#include "spectral/quadrature.hpp"

namespace kiloband {
namespace {

constexpr double kTolerance = 1e-9;  // relative, of the integrals

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

Channel effective_band(const Spectrum& response, const ChannelCover& cover) {
  double integral = 0, moment = 0, largest = 0;
  for (const auto& piece : cover.covered_nm()) {
    const std::vector<double> breaks = breaks_of(response, piece);
    integral += absolute_integral(response, piece.first, piece.second);
    moment += integrate([&](double nm) { return nm * std::abs(response(nm)); }, breaks, kTolerance);
    largest = std::max({largest, std::abs(response.max_over(piece.first, piece.second)),
                        std::abs(response.min_over(piece.first, piece.second))});
  }
  if (!(integral > 0)) return {cover.covered_nm().front().first, cover.covered_nm().back().second, ""};
  const double centre = moment / integral, half = 0.5 * integral / largest;
  // The edges of a box come back as they were given.
  return {without_roundings(centre - half), without_roundings(centre + half), ""};
}

}  // namespace kiloband
