#include "scene/compile/spectra/band_set.hpp"

#include <algorithm>

namespace kiloband {

BandPosition band_position(const BandSet& set, double lambda_nm) {
  const std::vector<double>& centres = set.centres_nm;
  BandPosition position;
  position.inside = set.extrapolate || (lambda_nm >= set.min_nm && lambda_nm <= set.max_nm);
  if (centres.size() < 2) return position;
  const auto above = std::upper_bound(centres.begin() + 1, centres.end() - 1, lambda_nm);
  position.index = static_cast<uint32_t>(above - centres.begin()) - 1;
  const double from = centres[position.index], to = centres[position.index + 1];
  position.fraction = std::clamp((lambda_nm - from) / (to - from), 0.0, 1.0);
  return position;
}

/// Piece by piece between band centres, where values are linear: their mean is that at the middle.
void add_mean_weights(const BandSet& set, const Channel& channel, std::span<double> out) {
  const std::vector<double>& centres = set.centres_nm;
  double from = set.extrapolate ? channel.min_nm : std::max(channel.min_nm, set.min_nm);
  const double end = set.extrapolate ? channel.max_nm : std::min(channel.max_nm, set.max_nm);
  while (from < end) {
    const auto next = std::upper_bound(centres.begin(), centres.end(), from);
    const double to = next == centres.end() ? end : std::min(end, *next);
    const BandPosition middle = band_position(set, 0.5 * (from + to));
    const double part = (to - from) / channel.width_nm();
    out[middle.index] += part * (1 - middle.fraction);
    if (middle.fraction > 0) out[middle.index + 1] += part * middle.fraction;
    from = to;
  }
}

Spectrum band_spectrum(const BandSet& set, std::span<const double> values) {
  std::vector<double> lambda_nm{set.min_nm}, knots{values.front()};
  lambda_nm.insert(lambda_nm.end(), set.centres_nm.begin(), set.centres_nm.end());
  knots.insert(knots.end(), values.begin(), values.end());
  lambda_nm.push_back(set.max_nm);
  knots.push_back(values.back());
  return Spectrum::tabulated(std::move(lambda_nm), std::move(knots), set.extrapolate).scaled(set.scale);
}

}  // namespace kiloband
