// Pictures of cubes.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cube_support.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

using namespace test;

TEST(Preview, D65IsWhite) {
  // The matching functions times D65, integrated over 5 nm bands, give (1, 1, 1) by definition of the white
  // point; the density inside a band is taken as constant, which costs below 1 %.
  const auto bands = equal_bands(360, 830, 94);
  const auto weights = preview_weights(bands);
  double rgb[3] = {};
  for (std::size_t k = 0; k < bands.size(); ++k)
    for (int c = 0; c < 3; ++c)
      rgb[c] += weights[k][c] * illuminant_d65().integral(bands[k].channel.min_nm, bands[k].channel.max_nm);
  for (const double component : rgb) EXPECT_NEAR(component, 1, 0.01);
}

TEST(Preview, WavelengthsHaveTheirColours) {
  const auto weights = preview_weights({{{640, 660, ""}, false},
                                        {{540, 550, ""}, false},
                                        {{440, 450, ""}, false},
                                        {{0, 0, "Y"}, true},
                                        {{8000, 9000, ""}, false}});
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t other = 0; other < 3; ++other)
      if (other != c) {
        EXPECT_GT(weights[c][c], weights[c][other]);
      }
  EXPECT_EQ(weights[3], (std::array<float, 3>{0, 0, 0}));
  EXPECT_EQ(weights[4], (std::array<float, 3>{0, 0, 0}));
}

/// What two channels cover counts once: an image in the same channels twice has the same colours.
TEST(Preview, OverlappingChannelsCountOnce) {
  for (const char* text : {"400:700:6", "1000:1600:6"}) {
    std::vector<Band> once;
    for (const Channel& channel : parse_channels(text)) once.push_back({channel, false});
    std::vector<Band> twice = once;
    twice.insert(twice.end(), once.begin(), once.end());
    const auto a = preview_weights(once), b = preview_weights(twice);
    for (std::size_t k = 0; k < once.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(b[k][c] + b[k + once.size()][c], a[k][c]) << text;
  }
}

TEST(Preview, InfraredIsShownInThirds) {
  const auto weights = preview_weights(equal_bands(8000, 14000, 4));
  EXPECT_EQ(weights[0], (std::array<float, 3>{0, 0, 1}));
  EXPECT_NEAR(weights[1][2], 1 / 3.0, 1e-6);  // 9500-11000 nm: a third below 10000
  EXPECT_NEAR(weights[1][1], 2 / 3.0, 1e-6);
  EXPECT_EQ(weights[3], (std::array<float, 3>{1, 0, 0}));
}

TEST(Preview, OnlyResponses) {
  const auto weights = preview_weights({{{0, 0, "a"}, true}});
  EXPECT_EQ(weights[0], (std::array<float, 3>{1, 1, 1}));
}

TEST(Preview, ExposureIgnoresTheBrightestPercent) {
  std::vector<float> rgb(300, 0.5f);
  rgb[4] = 1e6f;
  rgb[9] = NAN;
  EXPECT_EQ(auto_exposure(rgb), 2);
  EXPECT_EQ(auto_exposure(std::vector<float>(300, 0.0f)), 1);
  EXPECT_EQ(auto_exposure({}), 1);
}

TEST(Png, HoldsSrgbBytes) {
  const TemporaryFolder folder;
  const std::vector<float> rgb = {0, 1, 2, 0.5f, 0.2140411f, 0.001f, NAN, -1, INFINITY, 0, 0, 0};
  write_png(folder / "x.png", 2, 2, rgb);
  EXPECT_EQ(folder.list(), std::vector<std::string>{"x.png"});
  const auto input = OIIO::ImageInput::open((folder / "x.png").string());
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().width, 2);
  EXPECT_EQ(input->spec().nchannels, 3);
  std::vector<uint8_t> bytes(12);
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
  // sRGB: 0.5 -> 0.735357 -> 188; 0.2140411 -> 0.5 -> 127.5; 0.001 -> 0.01292 -> 3
  EXPECT_EQ(bytes[0], 0);
  EXPECT_EQ(bytes[1], 255);
  EXPECT_EQ(bytes[2], 255);
  EXPECT_EQ(bytes[3], 188);
  EXPECT_NEAR(bytes[4], 127.5, 0.51);
  EXPECT_EQ(bytes[5], 3);
  EXPECT_EQ(bytes[6], 0);
  EXPECT_EQ(bytes[7], 0);
  EXPECT_EQ(bytes[8], 255);
}

TEST(Png, FailsWithTheSystemsMessage) {
  const TemporaryFolder folder;
  const std::vector<float> rgb(3);
  const auto file = folder / "missing/x.png";
  EXPECT_EQ(error_of<DeviceError>([&] { write_png(file, 1, 1, rgb); }),
            "cannot write '" + file.string() + "': No such file or directory");
  EXPECT_THROW(write_png(folder / "x.png", 0, 1, {}), InputError);
}

}  // namespace
}  // namespace kiloband
