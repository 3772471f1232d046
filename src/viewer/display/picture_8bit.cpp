#include "viewer/display/picture_8bit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spectral/colour/colour.hpp"

namespace kiloband::viewer {
namespace {

constexpr double kWhite = 0.9;        // of the display, for the 99th percentile
constexpr float kMostDecades = 1e8f;  // of a logarithmic scale that is chosen automatically

/// Within [0, 1]; NaN becomes 0: an index is made of it.
float part_of_one(double x) {
  return x > 0 ? static_cast<float>(std::min(x, 1.0)) : 0.0f;
}

/// sRGB bytes of [0, 1] at 2^14 equal steps: half a step is 0.1 of a byte where the curve is steepest.
class SrgbBytes {
 public:
  SrgbBytes() {
    for (std::size_t i = 0; i < bytes_.size(); ++i)
      bytes_[i] = static_cast<uint8_t>(std::lround(255 * srgb_encode(static_cast<double>(i) / kSteps)));
  }
  uint8_t operator()(double linear) const {
    return bytes_[static_cast<std::size_t>(part_of_one(linear) * kSteps + 0.5f)];
  }

 private:
  static constexpr int kSteps = 1 << 14;
  std::array<uint8_t, kSteps + 1> bytes_{};
};

double filmic(double x) {
  x = std::clamp(x, 0.0, 1e6);  // the quotient tends to 1.03
  return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

/// 0 to 255 of a value within the range.
std::size_t index_of(float value, MapScale scale, const MapRange& range) {
  double low = range.low, high = range.high, at = value;
  if (scale == MapScale::kLogarithmic) {
    if (!(value > 0)) return 0;
    low = std::log(low), high = std::log(high), at = std::log(at);
  }
  return static_cast<std::size_t>(part_of_one((at - low) / (high - low)) * 255 + 0.5f);
}

Plane positive(Plane plane) {
  std::erase_if(plane.values, [](float v) { return !(v > 0); });
  return plane;
}

}  // namespace

double automatic_stops(const Plane& rgb) {
  const float brightest = quantile(rgb, 0.99, 0);
  return brightest > 0 ? std::log2(kWhite / brightest) : 0;
}

Picture8 tone_map(const Plane& rgb, double stops, Tone tone) {
  static const SrgbBytes kBytes;
  const double exposure = std::exp2(stops);  // of a dim scene beyond what a float holds
  Picture8 picture{rgb.width, rgb.height, std::vector<uint8_t>(rgb.values.size())};
  for (std::size_t i = 0; i < rgb.values.size(); i += 3) {
    const float* const from = &rgb.values[i];
    uint8_t* const to = &picture.rgb[i];
    if (std::isnan(from[0]) || std::isnan(from[1]) || std::isnan(from[2])) {
      std::ranges::copy(kNoSample, to);
      continue;
    }
    for (int c = 0; c < 3; ++c)
      to[c] = kBytes(tone == Tone::kFilmic ? filmic(from[c] * exposure) : from[c] * exposure);
  }
  return picture;
}

MapRange automatic_range(const Plane& plane, MapScale scale) {
  const bool logarithmic = scale == MapScale::kLogarithmic;
  const Plane above = logarithmic ? positive(plane) : Plane{};
  const Plane& values = logarithmic ? above : plane;
  MapRange range{quantile(values, 0.01, logarithmic ? 0.1f : 0.0f), quantile(values, 0.99, 1)};
  if (logarithmic) range.low = std::max(range.low, range.high / kMostDecades);
  if (range.high > range.low) return range;
  if (logarithmic) return {range.low / 2, range.low * 2};
  const float half = range.low == 0 ? 1.0f : 0.01f * std::abs(range.low);
  return {range.low - half, range.low + half};
}

Picture8 map_colours(const Plane& plane, MapName map, MapScale scale, const MapRange& range) {
  const ColourMap& colours = colour_map(map);
  Picture8 picture{plane.width, plane.height, std::vector<uint8_t>(plane.values.size() * 3)};
  for (std::size_t i = 0; i < plane.values.size(); ++i) {
    const float value = plane.values[i];
    std::ranges::copy(std::isnan(value) ? kNoSample : colours[index_of(value, scale, range)],
                      &picture.rgb[3 * i]);
  }
  return picture;
}

}  // namespace kiloband::viewer
