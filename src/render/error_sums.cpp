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

std::optional<double> ErrorSums::relative_error() const {
  std::optional<double> largest;
  for (const Sums& sums : bands_) {
    if (!(sums.mean > 0)) continue;
    const auto n = static_cast<double>(sums.pixels);
    largest = std::max(largest.value_or(0), std::sqrt(sums.variance / n) / (sums.mean / n));
  }
  return largest;
}

}  // namespace kiloband
