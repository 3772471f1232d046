#include "post/picture.hpp"

#include <algorithm>

namespace kiloband {
namespace {

/// Weights of the bands; derived ones do not count unless they are what is shown.
std::vector<std::array<float, 3>> weights_of(const CubeInfo& info, PictureColours colours) {
  if (colours == PictureColours::kNatural) {
    if (!shows_visible_light(info.bands)) throw InputError("picture: no channel lies in 380-780 nm");
    return preview_weights(info.bands);
  }
  if (colours == PictureColours::kFalse) return false_colour_weights(info.bands);
  std::vector<Band> sensors = info.bands;
  for (Band& band : sensors) band.derived = true;
  return preview_weights(sensors);
}

}  // namespace

std::vector<float> make_picture(CubeReader& cube, PictureColours colours) {
  const CubeInfo& info = cube.info();
  const std::size_t bands = info.bands.size();
  auto weights = weights_of(info, colours);
  for (std::size_t k = 0; k < bands; ++k)
    if (info.quantity == Quantity::kDensity && !info.bands[k].derived)
      for (float& w : weights[k]) w *= static_cast<float>(info.bands[k].channel.width_nm());
  std::vector<float> rgb, row(info.width * bands);
  for (uint32_t y = 0; y < info.height; ++y) {
    cube.read_rows(y, 1, row, {});
    for (uint32_t x = 0; x < info.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        float sum = 0;
        for (std::size_t k = 0; k < bands; ++k)
          if (weights[k][c] != 0) sum += weights[k][c] * row[x * bands + k];
        rgb.push_back(sum);
      }
  }
  return rgb;
}

}  // namespace kiloband
