#include "render/error_sums.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kiloband {

namespace {

bool any_nan(std::span<const double> values) {
  int count = 0;
  for (const double value : values) count += value != value;
  return count > 0;
}

}  // namespace

// Without branches, so that the loops are vectorised: every pixel of an image comes by here.
void ErrorSums::add(std::span<const double> means, std::span<const double> variances) {
  if (means.size() != means_.size() || variances.size() != means_.size())
    throw std::logic_error("ErrorSums::add: a pixel has one mean and one variance per band");
  if (!any_nan(variances)) {
    for (std::size_t band = 0; band < means_.size(); ++band) {
      means_[band] += means[band];
      variances_[band] += variances[band];
      ++pixels_[band];
    }
    return;
  }
  for (std::size_t band = 0; band < means_.size(); ++band) {
    if (std::isnan(variances[band])) continue;
    means_[band] += means[band];
    variances_[band] += variances[band];
    ++pixels_[band];
  }
}

BandErrors ErrorSums::errors() const {
  BandErrors result;
  std::vector<double> all;
  for (std::size_t band = 0; band < means_.size(); ++band) {
    if (pixels_[band] == 0) continue;
    const auto n = static_cast<double>(pixels_[band]);
    const double mean = std::abs(means_[band] / n);  // responses may be negative
    if (!(mean > 0)) {
      ++result.dark_bands;
      continue;
    }
    all.push_back(std::sqrt(variances_[band] / n) / mean);
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
