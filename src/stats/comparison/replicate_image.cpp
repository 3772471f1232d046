#include "stats/comparison/replicate_image.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kiloband::stats {

void check_shape(const ReplicateImage& image) {
  const std::size_t units = image.pixels() * image.replicates;
  if (image.samples.size() != units || image.means.size() != units * image.channels)
    throw std::logic_error("ReplicateImage: the arrays do not fit width, height, channels and replicates");
}

const char* name_of(Scale scale) {
  switch (scale) {
    case Scale::kPixel:
      return "pixel";
    case Scale::kTile:
      return "tile";
    case Scale::kImage:
      return "image";
  }
  throw std::logic_error("name_of: unknown scale");
}

std::size_t UnitSample::sampled() const {
  return static_cast<std::size_t>(std::ranges::count_if(weights, [](double w) { return w > 0; }));
}

std::size_t gather_pixel(const ReplicateImage& image, std::size_t pixel, UnitSample& out) {
  out.channels = image.channels;
  out.means.assign(image.replicates * image.channels, 0);
  out.weights.assign(image.replicates, 0);
  std::size_t lost = 0;
  for (uint32_t r = 0; r < image.replicates; ++r) {
    const uint64_t samples = image.samples_at(r, pixel);
    if (samples == 0) continue;
    const float* from = &image.means[(r * image.pixels() + pixel) * image.channels];
    if (!std::all_of(from, from + image.channels, [](float v) { return std::isfinite(v); })) {
      ++lost;
      continue;
    }
    std::copy(from, from + image.channels,
              out.means.begin() + static_cast<std::ptrdiff_t>(r * image.channels));
    out.weights[r] = static_cast<double>(samples);
  }
  return lost;
}

Pool::Pool(std::size_t replicates, std::size_t channels)
    : channels_(channels), sums_(replicates * channels), weights_(replicates) {}

void Pool::add(const UnitSample& unit) {
  for (std::size_t r = 0; r < weights_.size(); ++r) {
    weights_[r] += unit.weights[r];
    for (std::size_t c = 0; c < channels_; ++c)
      sums_[r * channels_ + c] += unit.weights[r] * unit.mean_at(r, c);
  }
}

void Pool::add_marked(const UnitSample& unit, const std::vector<bool>& channels) {
  for (std::size_t r = 0; r < weights_.size(); ++r) {
    weights_[r] += unit.weights[r];
    for (std::size_t c = 0; c < channels_; ++c) {
      if (channels[c]) sums_[r * channels_ + c] += unit.weights[r] * unit.mean_at(r, c);
    }
  }
}

UnitSample Pool::mean() const {
  UnitSample unit{channels_, sums_, weights_};
  for (std::size_t r = 0; r < weights_.size(); ++r) {
    if (weights_[r] == 0) continue;
    for (std::size_t c = 0; c < channels_; ++c) unit.means[r * channels_ + c] /= weights_[r];
  }
  return unit;
}

void Pool::clear() {
  std::ranges::fill(sums_, 0);
  std::ranges::fill(weights_, 0);
}

}  // namespace kiloband::stats
