// Cubes as pictures: XYZ through the matching functions where there is visible light, false colour elsewhere.
#include <algorithm>
#include <cmath>

#include "cube/channel_cover.hpp"
#include "cube/cube_layout.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

constexpr double kVisibleMinNm = 380, kVisibleMaxNm = 780;

/// Linear sRGB per unit of band radiance. With a constant density inside the band,
/// X = integral of xbar * value / width, so the weight is the mean of xbar over the band.
/// What several channels cover counts once: xbar times the channel's share of it.
std::array<float, 3> colour_weight(const Channel& c, const ChannelCover& cover) {
  const auto mean = [&](const Spectrum& s) {
    double integral = 0;
    cover.for_shares(c, [&](double a, double b, double share) { integral += s.integral(a, b) * share; });
    return integral / (c.max_nm - c.min_nm) / kCieYIntegral;
  };
  const auto rgb = xyz_to_linear_srgb({mean(cie_x()), mean(cie_y()), mean(cie_z())});
  return {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
}

/// Share of the band that lies in each third of [low, low + 3 third], what several cover shared among them: long waves red,
/// short waves blue.
std::array<float, 3> false_colour_weight(const Channel& c, const ChannelCover& cover, double low,
                                         double third) {
  std::array<float, 3> weight;
  for (int part = 0; part < 3; ++part) {
    const double begin = low + part * third, end = begin + third;
    double share = 0;
    cover.for_shares(c, [&](double from, double to, double part_of_it) {
      share += std::max(std::min(to, end) - std::max(from, begin), 0.0) * part_of_it;
    });
    weight[static_cast<std::size_t>(2 - part)] = static_cast<float>(share / c.width_nm());
  }
  return weight;
}

}  // namespace

bool shows_visible_light(const std::vector<Band>& bands) {
  return std::any_of(bands.begin(), bands.end(), [](const Band& band) {
    return !band.derived && band.channel.min_nm < kVisibleMaxNm && band.channel.max_nm > kVisibleMinNm;
  });
}

std::vector<std::array<float, 3>> false_colour_weights(const std::vector<Band>& bands) {
  std::vector<std::array<float, 3>> weights(bands.size(), {0, 0, 0});
  const ChannelList channels = channels_of(bands);
  if (channels.empty()) throw InputError("picture: the cube has no channels, only derived bands");
  const Channel range = hull(channels);
  const ChannelCover cover(channels);
  for (std::size_t k = 0; k < bands.size(); ++k)
    if (!bands[k].derived)
      weights[k] = false_colour_weight(bands[k].channel, cover, range.min_nm, range.width_nm() / 3);
  return weights;
}

std::vector<std::array<float, 3>> preview_weights(const std::vector<Band>& bands) {
  std::vector<std::array<float, 3>> weights(bands.size(), {0, 0, 0});
  if (channels_of(bands)
          .empty()) {  // sensor responses only: the first three as red, green, blue; one as grey
    for (std::size_t c = 0; c < 3 && !bands.empty(); ++c) weights[std::min(c, bands.size() - 1)][c] = 1;
    return weights;
  }
  if (!shows_visible_light(bands)) return false_colour_weights(bands);
  const ChannelCover cover(channels_of(bands));
  for (std::size_t k = 0; k < bands.size(); ++k)
    if (!bands[k].derived) weights[k] = colour_weight(bands[k].channel, cover);
  return weights;
}

float auto_exposure(std::span<const float> linear_rgb) {
  std::vector<float> brightest;
  brightest.reserve(linear_rgb.size() / 3);
  for (std::size_t i = 0; i + 2 < linear_rgb.size(); i += 3) {
    const float largest = std::max({linear_rgb[i], linear_rgb[i + 1], linear_rgb[i + 2]});
    if (std::isfinite(largest)) brightest.push_back(largest);
  }
  if (brightest.empty()) return 1;
  const auto rank =
      brightest.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(brightest.size() - 1));
  std::nth_element(brightest.begin(), rank, brightest.end());
  const float scale = 1 / *rank;
  return *rank > 0 && std::isfinite(scale) ? scale : 1;
}

}  // namespace kiloband
