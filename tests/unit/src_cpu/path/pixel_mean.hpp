// An image's mean, where pixels are independent estimates of one number.
#pragma once

#include "tests/support/render_harness.hpp"

namespace kiloband::test {

struct PixelMean {
  double mean = 0, variance = 0;
};

/// Of the first channel, over all pixels.
inline PixelMean mean_of_pixels(const RenderResult& result) {
  PixelMean of;
  const std::size_t pixels = std::size_t{result.width} * result.height;
  const auto count = static_cast<double>(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    of.mean += result.mean[pixel * result.channels] / count;
    of.variance += result.variance[pixel * result.channels] / (count * count);
  }
  return of;
}

}  // namespace kiloband::test
