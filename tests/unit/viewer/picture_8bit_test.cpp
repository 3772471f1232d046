#include "viewer/display/picture_8bit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "spectral/colour/colour.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;

Plane greys(const std::vector<float>& values) {
  Plane plane{static_cast<uint32_t>(values.size()), 1, 3, {}};
  for (const float v : values) plane.values.insert(plane.values.end(), {v, v, v});
  return plane;
}

TEST(ToneMap, IsSrgbToOneLevel) {
  std::vector<float> values;
  for (int i = 0; i <= 5000; ++i) values.push_back(static_cast<float>(i) / 5000);
  const Picture8 picture = tone_map(greys(values), 0, Tone::kSrgb);
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_LE(std::abs(picture.rgb[3 * i] - 255 * srgb_encode(values[i])), 0.7) << values[i];
  EXPECT_EQ(picture.rgb.front(), 0);
  EXPECT_EQ(picture.rgb.back(), 255);
}

TEST(ToneMap, StopsDouble) {
  const Picture8 brighter = tone_map(greys({0.1f, 0.2f, -3, INFINITY}), 2, Tone::kSrgb);
  const Picture8 plain = tone_map(greys({0.4f, 0.8f, 0, 1}), 0, Tone::kSrgb);
  EXPECT_EQ(brighter.rgb, plain.rgb);
}

TEST(ToneMap, FilmicHasAShoulderAndKeepsBlack) {
  const Picture8 picture = tone_map(greys({0, 0.18f, 1, 4, 1e30f}), 0, Tone::kFilmic);
  EXPECT_EQ(picture.rgb[0], 0);
  // 0.18 (2.51 0.18 + 0.03) / (0.18 (2.43 0.18 + 0.59) + 0.14) = 0.26689 and 1 gives 0.80380: sRGB 141.5 and 231.2
  EXPECT_NEAR(picture.rgb[3], 141, 1);
  EXPECT_NEAR(picture.rgb[6], 231, 1);
  EXPECT_GT(picture.rgb[9], picture.rgb[6]);
  EXPECT_EQ(picture.rgb[12], 255);
}

TEST(ToneMap, PixelsWithoutSampleAreTold) {
  const Picture8 picture = tone_map(greys({NAN}), 5, Tone::kSrgb);
  EXPECT_EQ((Colour{picture.rgb[0], picture.rgb[1], picture.rgb[2]}), kNoSample);
}

TEST(ToneMap, AutomaticExposureIsThePercentile) {
  std::vector<float> values;
  for (int i = 0; i <= 100; ++i) values.push_back(static_cast<float>(i));
  EXPECT_NEAR(automatic_stops(greys(values)), std::log2(0.9 / 99), 1e-6);
  EXPECT_EQ(automatic_stops(greys({0, 0})), 0);
}

/// Radiances at which the exposure, or its product with them, is no float any more.
TEST(ToneMap, AnyBrightnessIsAPicture) {
  for (const float brightest : {1e-39f, 1e-45f, 1e30f, 3e38f, INFINITY}) {
    const Plane plane = greys({0, brightest / 2, brightest});
    for (const double more : {-10.0, 0.0, 35.0, 64.0})
      for (const Tone tone : {Tone::kSrgb, Tone::kFilmic}) {
        const Picture8 picture = tone_map(plane, automatic_stops(plane) + more, tone);
        EXPECT_EQ(picture.rgb[0], 0) << brightest;
        const bool bright = more >= 0 && brightest < INFINITY;
        EXPECT_GT(picture.rgb[6], bright ? 220 : -1) << brightest << " " << more;
      }
  }
}

Colour pixel(const Picture8& picture, std::size_t i) {
  return {picture.rgb[3 * i], picture.rgb[3 * i + 1], picture.rgb[3 * i + 2]};
}

TEST(MapColours, EndsAndMiddle) {
  const Plane plane{5, 1, 1, {-1, 2, 4, 6, 9}};
  const ColourMap& map = colour_map(MapName::kViridis);
  const Picture8 picture = map_colours(plane, MapName::kViridis, MapScale::kLinear, {2, 6});
  EXPECT_EQ(pixel(picture, 0), map[0]);
  EXPECT_EQ(pixel(picture, 1), map[0]);
  EXPECT_EQ(pixel(picture, 2), map[128]);
  EXPECT_EQ(pixel(picture, 3), map[255]);
  EXPECT_EQ(pixel(picture, 4), map[255]);
}

TEST(MapColours, LogarithmicScaleIsEvenInDecades) {
  const Plane plane{5, 1, 1, {1e-4f, 1e-3f, 1e-1f, 0, NAN}};
  const ColourMap& map = colour_map(MapName::kMagma);
  const Picture8 picture = map_colours(plane, MapName::kMagma, MapScale::kLogarithmic, {1e-4f, 1e-1f});
  EXPECT_EQ(pixel(picture, 0), map[0]);
  EXPECT_EQ(pixel(picture, 1), map[85]);
  EXPECT_EQ(pixel(picture, 2), map[255]);
  EXPECT_EQ(pixel(picture, 3), map[0]);
  EXPECT_EQ(pixel(picture, 4), kNoSample);
}

TEST(MapColours, AutomaticRangeIsNeverEmpty) {
  const MapRange flat = automatic_range({2, 1, 1, {5, 5}}, MapScale::kLinear);
  EXPECT_LT(flat.low, 5);
  EXPECT_GT(flat.high, 5);
  const MapRange dark = automatic_range({2, 1, 1, {0, 0}}, MapScale::kLogarithmic);
  EXPECT_GT(dark.low, 0);
  EXPECT_GT(dark.high, dark.low);
  const MapRange wide = automatic_range({3, 1, 1, {0, 1e-20f, 1}}, MapScale::kLogarithmic);
  EXPECT_FLOAT_EQ(wide.low, 1e-8f);
  EXPECT_EQ(wide.high, 1);
}

/// Published ends and middles; lightness rises all along the maps.
TEST(ColourMaps, ArePublishedOnes) {
  EXPECT_EQ(to_hex(colour_map(MapName::kViridis)[0]), "#440154");
  EXPECT_EQ(to_hex(colour_map(MapName::kViridis)[255]), "#fde725");
  EXPECT_EQ(to_hex(colour_map(MapName::kMagma)[255]), "#fcfdbf");
  EXPECT_EQ(to_hex(colour_map(MapName::kCividis)[255]), "#fee838");
  EXPECT_EQ(to_hex(colour_map(MapName::kGrey)[17]), "#111111");
  for (const char* name : {"viridis", "magma", "cividis", "grey"}) {
    double before = -1;
    for (const Colour& c : colour_map(*find_colour_map(name))) {
      const auto linear = [](uint8_t v) { return std::pow(v / 255.0, 2.2); };
      const double light = 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
      EXPECT_GT(light, before - 3e-3) << name;
      before = light;
    }
  }
  EXPECT_FALSE(find_colour_map("jet"));
}

/// Bounds whose difference or ratio is no float, and values beyond them.
TEST(MapColours, AnyRangeIsAPicture) {
  constexpr float kMost = std::numeric_limits<float>::max(),
                  kLeast = std::numeric_limits<float>::denorm_min();
  const Plane plane{7, 1, 1, {-INFINITY, -kMost, 0, kLeast, 1, kMost, INFINITY}};
  const ColourMap& map = colour_map(MapName::kGrey);
  for (const auto& [scale, range] : {std::pair{MapScale::kLinear, MapRange{-kMost, kMost}},
                                     {MapScale::kLinear, MapRange{0, kLeast}},
                                     {MapScale::kLinear, MapRange{kMost, kMost}},
                                     {MapScale::kLogarithmic, MapRange{kLeast, kMost}},
                                     {MapScale::kLogarithmic, MapRange{1, 1}}}) {
    const Picture8 picture = map_colours(plane, MapName::kGrey, scale, range);
    EXPECT_EQ(pixel(picture, 0), map.front());
    if (range.low < range.high) {
      EXPECT_EQ(pixel(picture, 6), map.back());
    }
  }
  const Picture8 middle = map_colours(plane, MapName::kGrey, MapScale::kLinear, {-kMost, kMost});
  EXPECT_EQ(pixel(middle, 2), map[128]);
}

}  // namespace
}  // namespace kiloband::test
