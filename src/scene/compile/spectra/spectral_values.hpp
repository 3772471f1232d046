// The numbers of spectral images, texel by texel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "scene/description/description.hpp"

namespace kiloband {

inline std::span<const float> texel(const SpectralImage& image, std::size_t i) {
  return std::span(*image.values).subspan(i * image.values_per_pixel, image.values_per_pixel);
}

inline double dot(std::span<const float> values, std::span<const double> weights) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += values[i] * weights[i];
  return sum;
}

/// The mean and the largest of every value over the image; row_weights: of its rows, their mean is 1.
struct ValueStatistics {
  std::vector<double> mean, largest;

  ValueStatistics(const SpectralImage& image, std::span<const double> row_weights)
      : mean(image.values_per_pixel, 0.0), largest(image.values_per_pixel, 0.0) {
    const std::size_t count = std::size_t{image.width} * image.height;
    for (std::size_t i = 0; i < count; ++i) {
      const std::span<const float> values = texel(image, i);
      const double weight = row_weights[i / image.width] / static_cast<double>(count);
      for (std::size_t v = 0; v < values.size(); ++v) {
        mean[v] += weight * values[v];
        largest[v] = std::max(largest[v], double{values[v]});
      }
    }
  }
};

}  // namespace kiloband
