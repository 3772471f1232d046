#include "render/error_sums.hpp"

#include <algorithm>
#include <cmath>

namespace kiloband {

void ErrorSums::add(std::size_t band, double mean, double variance) {
  if (std::isnan(variance)) return;
  Sums& sums = bands_[band];
  sums.mean += mean;
  sums.variance += variance;
  ++sums.pixels;
}

BandErrors ErrorSums::errors() const {
  BandErrors result;
  std::vector<double> all;
  for (std::size_t band = 0; band < bands_.size(); ++band) {
    const Sums& sums = bands_[band];
    if (sums.pixels == 0) continue;
    const auto n = static_cast<double>(sums.pixels);
    const double mean = std::abs(sums.mean / n);  // responses may be negative
    if (!(mean > 0)) {
      ++result.dark_bands;
      continue;
    }
    all.push_back(std::sqrt(sums.variance / n) / mean);
    if (result.worst && !(all.back() > *result.worst)) continue;
    result.worst = all.back();
    result.worst_band = band;
  }
  if (all.empty()) return result;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::ranges::nth_element(all, middle);
  result.median = *middle;
  return result;
}

}  // namespace kiloband
