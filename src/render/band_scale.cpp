#include "render/band_scale.hpp"

#include <limits>

namespace kiloband {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

/// Counts per pixel are 32 bits wide, so that they are added as the values are.
struct Counts {
  uint32_t zero = 0, not_finite = 0;
};

Counts scale_means(std::size_t bands, const float* __restrict film, const double* __restrict scale,
                   double* __restrict exact, float* __restrict stored) {
  Counts counts;
  for (std::size_t b = 0; b < bands; ++b) {
    exact[b] = film[b] * scale[b];
    const auto value = static_cast<float>(exact[b]);
    stored[b] = value;
    counts.zero += static_cast<uint32_t>(film[b] > 0) & static_cast<uint32_t>(value == 0);
    counts.not_finite += !(value >= -kLargest) | !(value <= kLargest);
  }
  return counts;
}

Counts scale_variances(std::size_t bands, const float* __restrict film, const double* __restrict scale,
                       double* __restrict exact, float* __restrict stored) {
  Counts counts;
  for (std::size_t b = 0; b < bands; ++b) {
    exact[b] = double{film[b]} * scale[b] * scale[b];
    const auto value = static_cast<float>(exact[b]);
    stored[b] = value;
    counts.zero += static_cast<uint32_t>(film[b] > 0) & static_cast<uint32_t>(value == 0);
    counts.not_finite += value > kLargest;
  }
  return counts;
}

}  // namespace

BandScale::BandScale(const std::vector<std::size_t>& film_channels, const std::vector<double>& film_scale)
    : channels_(film_channels), picked_(film_channels.size()) {
  for (std::size_t b = 0; b < channels_.size(); ++b) {
    scale_.push_back(film_scale.at(channels_[b]));
    in_order_ = in_order_ && channels_[b] == b;
  }
}

const float* BandScale::bands_of(const float* film) {
  if (in_order_) return film;
  for (std::size_t b = 0; b < channels_.size(); ++b) picked_[b] = film[channels_[b]];
  return picked_.data();
}

void BandScale::means(const float* film, std::span<double> exact, float* stored, RangeLosses& losses) {
  const Counts counts = scale_means(scale_.size(), bands_of(film), scale_.data(), exact.data(), stored);
  losses.underflowed += counts.zero;
  losses.overflowed += counts.not_finite;
}

void BandScale::variances(const float* film, std::span<double> exact, float* stored, RangeLosses& losses) {
  const Counts counts = scale_variances(scale_.size(), bands_of(film), scale_.data(), exact.data(), stored);
  losses.underflowed_variances += counts.zero;
  losses.overflowed_variances += counts.not_finite;
}

}  // namespace kiloband
