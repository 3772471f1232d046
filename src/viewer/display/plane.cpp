#include "viewer/display/plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/deal_ranges.hpp"
#include "base/text.hpp"
#include "viewer/display/brightness.hpp"
#include "viewer/display/three_sums.hpp"

namespace kiloband::viewer {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// A plane of one component whose pixels are functions of the means of a band.
template <class Value>
Plane plane_of_band(const PixelSource& source, std::size_t band, unsigned threads, const Value& value) {
  Plane plane{source.width(), source.height(), 1, {}};
  plane.values.resize(std::size_t{plane.width} * plane.height);
  deal_ranges(plane.height, threads, [&](std::size_t first, std::size_t end) {
    std::vector<float> row;
    for (auto y = static_cast<uint32_t>(first); y < end; ++y) {
      const std::span<float> means =
          std::span(plane.values).subspan(std::size_t{y} * plane.width, plane.width);
      source.band_means(y, band, means, row);
      for (float& mean : means) mean = static_cast<float>(value(mean));
    }
  });
  return plane;
}

}  // namespace

ThreeSums::ThreeSums(const PixelSource& source, const RgbWeights& of_integrals) {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < of_integrals.size(); ++k)
      weights_[c].push_back(static_cast<float>(of_integrals[k][c] * source.units()[k]));
}

void ThreeSums::operator()(const float* values, float* out) const {
  three_sums({weights_[0].data(), weights_[1].data(), weights_[2].data()}, values, weights_[0].size(), out);
  if (std::isfinite(out[0]) && std::isfinite(out[1]) && std::isfinite(out[2])) return;
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0;
    for (std::size_t k = 0; k < weights_[c].size(); ++k)
      if (weights_[c][k] != 0) sum += double{weights_[c][k]} * values[k];
    out[c] = static_cast<float>(sum);
  }
}

void PixelSource::band_means(uint32_t y, std::size_t band, std::span<float> out,
                             std::vector<float>& row) const {
  const std::size_t bands = this->bands().size();
  row.resize(width() * bands);
  means(y, row);
  for (std::size_t x = 0; x < width(); ++x) out[x] = row[x * bands + band];
}

void PixelSource::sums(uint32_t y, const ThreeSums& of_row, std::span<float> out) const {
  const std::size_t bands = this->bands().size();
  std::vector<float> row(width() * bands);
  means(y, row);
  for (std::size_t x = 0; x < width(); ++x) of_row(&row[x * bands], &out[3 * x]);
}

Plane weighted_plane(const PixelSource& source, const RgbWeights& weights, unsigned threads) {
  Plane plane{source.width(), source.height(), 3, {}};
  plane.values.resize(std::size_t{plane.width} * plane.height * 3);
  const ThreeSums sums(source, weights);
  source.prepare(sums);
  const std::size_t row = std::size_t{plane.width} * 3;
  deal_ranges(plane.height, threads, [&](std::size_t first, std::size_t end) {
    for (auto y = static_cast<uint32_t>(first); y < end; ++y)
      source.sums(y, sums, std::span(plane.values).subspan(y * row, row));
  });
  return plane;
}

Plane channel_plane(const PixelSource& source, const ChannelOf& channel, unsigned threads) {
  const Band& band = source.bands().at(channel.band);
  const double scale = source.units()[channel.band] / (band.derived ? 1 : band.channel.width_nm());
  return plane_of_band(source, channel.band, threads, [&](float mean) { return mean * scale; });
}

Plane temperature_plane(const PixelSource& source, const TemperatureOf& channel, unsigned threads) {
  const BrightnessTemperature temperature(source.bands().at(channel.band).channel);
  const double unit = source.units()[channel.band];
  return plane_of_band(source, channel.band, threads, [&](float mean) { return temperature(mean * unit); });
}

Plane error_plane(const PixelSource& source, unsigned threads) {
  const std::size_t bands = source.bands().size();
  Plane plane{source.width(), source.height(), 1, {}};
  plane.values.resize(std::size_t{plane.width} * plane.height);
  deal_ranges(plane.height, threads, [&](std::size_t first, std::size_t end) {
    std::vector<float> means(plane.width * bands), variances(plane.width * bands);
    for (auto y = static_cast<uint32_t>(first); y < end; ++y) {
      source.means(y, means);
      source.variances(y, variances);
      for (uint32_t x = 0; x < plane.width; ++x) {
        double sum = 0, error = 0;
        for (std::size_t k = 0; k < bands; ++k) {
          const float mean = means[x * bands + k], variance = variances[x * bands + k];
          if (source.bands()[k].derived || std::isnan(mean) || std::isnan(variance)) continue;
          sum += mean * source.units()[k];
          error += std::sqrt(variance) * source.units()[k];
        }
        plane.values[std::size_t{y} * plane.width + x] = sum > 0 ? static_cast<float>(error / sum) : kNothing;
      }
    }
  });
  return plane;
}

RgbWeights range_weights(const std::vector<Band>& bands, const std::array<Channel, 3>& ranges) {
  RgbWeights weights(bands.size(), {0, 0, 0});
  for (std::size_t c = 0; c < 3; ++c) {
    double total = 0;
    std::vector<double> overlaps;
    for (const Band& band : bands) {
      const double low = std::max(band.channel.min_nm, ranges[c].min_nm);
      const double high = std::min(band.channel.max_nm, ranges[c].max_nm);
      overlaps.push_back(band.derived ? 0 : std::max(0.0, high - low));
      total += overlaps.back();
    }
    if (!(total > 0)) throw InputError("the range " + band_range_text(ranges[c]) + " overlaps no channel");
    for (std::size_t k = 0; k < bands.size(); ++k)
      if (overlaps[k] > 0)
        weights[k][c] = static_cast<float>(overlaps[k] / total / bands[k].channel.width_nm());
  }
  return weights;
}

std::string band_range_text(const Channel& range) {
  return format_number(range.min_nm) + "-" + format_number(range.max_nm) + " nm";
}

float quantile(const Plane& plane, double p, float fallback) {
  constexpr std::size_t kMost = std::size_t{1} << 16;
  const std::size_t pixels = plane.values.size() / plane.components;
  std::size_t step = pixels / kMost + 1;
  while (std::gcd(step, std::size_t{plane.width}) > 1) ++step;  // in every column
  std::vector<float> finite;
  for (std::size_t i = 0; i < pixels; i += step) {
    const float* const pixel = &plane.values[i * plane.components];
    const float largest = *std::max_element(pixel, pixel + plane.components);
    if (std::isfinite(largest)) finite.push_back(largest);
  }
  if (finite.empty()) return fallback;
  const auto rank =
      finite.begin() + static_cast<std::ptrdiff_t>(std::lround(p * static_cast<double>(finite.size() - 1)));
  std::nth_element(finite.begin(), rank, finite.end());
  return *rank;
}

}  // namespace kiloband::viewer
