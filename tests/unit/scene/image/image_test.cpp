// Images that are right, in every format.
#include "scene/image/image.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "image_support.hpp"
#include "spectral/colour/colour.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/unit/scene/mesh/binary.hpp"

namespace kiloband::test {
namespace {

constexpr int kWidth = 5, kHeight = 3;

struct Images : testing::Test {
  TemporaryFolder folder;
};

/// The picture has the ramp's values, up to `tolerance`, after `decode`.
void expect_ramp(
    const Image& image, double tolerance, double (*decode)(double) = [](double v) { return v; }) {
  EXPECT_EQ(image.width, 5u);
  EXPECT_EQ(image.height, 3u);
  EXPECT_EQ(image.channels, 3u);
  const std::vector<float> expected = ramp(kWidth * kHeight * 3);
  ASSERT_EQ(image.pixels.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(image.pixels[i], decode(expected[i]), tolerance) << i;
}

TEST_F(Images, FloatFormatsAreLinear) {
  const auto values = ramp(kWidth * kHeight * 3);
  expect_ramp(
      read_image(write_image(folder / "a.exr", kWidth, kHeight, kRgb, values, OIIO::TypeFloat), false), 0);
  expect_ramp(read_image(write_image(folder / "b.exr", kWidth, kHeight, kRgb, values, OIIO::TypeHalf), false),
              1e-3);
  expect_ramp(
      read_image(write_image(folder / "c.tif", kWidth, kHeight, kRgb, values, OIIO::TypeFloat), false), 0);
  // One shared 8-bit exponent, set by the largest channel of a pixel.
  expect_ramp(
      read_image(write_image(folder / "d.hdr", kWidth, kHeight, kRgb, values, OIIO::TypeFloat), false),
      1.0 / 128);
}

TEST_F(Images, PicturesOfSpectralImagesAreWarnedOf) {
  Messages messages;
  const auto read = [&](const std::vector<std::string>& channels) {
    const auto file = write_image(folder / "a.exr", 1, 1, channels, std::vector<float>(channels.size(), 1),
                                  OIIO::TypeFloat);
    EXPECT_EQ(read_image(file, false, messages.lines(folder)).channels, 3u);
  };
  read({"R", "G", "B", "response.S0"});
  EXPECT_TRUE(messages.texts.empty());
  read({"R", "G", "B", "T.500nm"});
  EXPECT_EQ(messages.texts,
            std::vector<std::string>{"a.exr: warning: a spectral image: only its RGB picture is "
                                     "read here; spectral_bitmap and spectral_envmap read its "
                                     "bands"});
}

TEST_F(Images, IntegersAreDecodedFromSrgbUnlessRaw) {
  const auto values = ramp(kWidth * kHeight * 3);
  for (const char* name : {"a.png", "a.tif", "a.bmp", "a.tga", "a.ppm"}) {
    const auto path = write_image(folder / name, kWidth, kHeight, kRgb, values, OIIO::TypeUInt8);
    SCOPED_TRACE(name);
    expect_ramp(read_image(path, true), 0.5 / 255 + 1e-6);
    expect_ramp(read_image(path, false), 2.3 * 0.5 / 255 + 1e-6,
                srgb_decode);  // the curve's slope is below 2.3
  }
  for (const char* name : {"b.png", "b.tif"}) {
    const auto path = write_image(folder / name, kWidth, kHeight, kRgb, values, OIIO::TypeUInt16);
    SCOPED_TRACE(name);
    expect_ramp(read_image(path, true), 0.5 / 65535 + 1e-6);
    expect_ramp(read_image(path, false), 2.3 * 0.5 / 65535 + 1e-6, srgb_decode);
  }
}

TEST_F(Images, JpegIsRead) {
  const auto path =
      write_image(folder / "a.jpg", 64, 32, kRgb, std::vector<float>(64 * 32 * 3, 0.5f), OIIO::TypeUInt8);
  const Image image = read_image(path, true);
  EXPECT_EQ(image.width, 64u);
  for (const float value : image.pixels) EXPECT_NEAR(value, 0.5, 0.02);
}

// Written byte by byte, so that the order of rows does not depend on one library reading what it wrote.
TEST_F(Images, RowZeroIsTheTop) {
  const Image ppm =
      read_image(folder.write("a.ppm", "P6\n1 2\n255\n" + std::string("\xff\x00\x00\x00\x00\xff", 6)), true);
  EXPECT_EQ(ppm.pixels, (std::vector<float>{1, 0, 0, 0, 0, 1}));
  // PFM and BMP store the bottom row first.
  const Image pfm = read_image(folder.write("b.pfm", "Pf\n1 2\n-1.0\n" + raw<float>({0.25f, 0.75f})), false);
  EXPECT_EQ(pfm.channels, 1u);
  EXPECT_EQ(pfm.pixels, (std::vector<float>{0.75f, 0.25f}));
  const std::string header = "BM" + raw<uint32_t>(62) + raw<uint32_t>(0) + raw<uint32_t>(54) +
                             raw<uint32_t>(40) + raw<int32_t>(1) + raw<int32_t>(2) + raw<uint16_t>(1) +
                             raw<uint16_t>(24) + raw<uint32_t>({0, 8, 0, 0, 0, 0});
  const std::string rows("\x00\x00\xff\x00\xff\x00\x00\x00", 8);  // bottom red, top blue; B G R and padding
  EXPECT_EQ(read_image(folder.write("c.bmp", header + rows), true).pixels,
            (std::vector<float>{0, 0, 1, 1, 0, 0}));
}

TEST_F(Images, HdrWrittenByHand) {
  // Radiance RGBE: value = mantissa / 256 * 2^(exponent - 128); no run lengths below a width of 8.
  const std::string file = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 1\n" +
                           std::string("\x80\x40\x00\x81\x80\x80\x80\x82", 8);
  const Image image = read_image(folder.write("a.hdr", file), false);
  ASSERT_EQ(image.pixels.size(), 6u);
  EXPECT_NEAR(image.pixels[0], 1.0, 0.01);
  EXPECT_NEAR(image.pixels[1], 0.5, 0.01);
  EXPECT_NEAR(image.pixels[3], 2.0, 0.02);
}

TEST_F(Images, AlphaIsDroppedAndNotMultiplied) {
  const std::vector<std::string> rgba = {"R", "G", "B", "A"};
  const std::vector<float> pixel = {0.4f, 0.6f, 0.8f, 0.2f};
  const auto unassociated = [](OIIO::ImageSpec& spec) { spec["oiio:UnassociatedAlpha"] = 1; };
  for (const char* name : {"a.png", "a.tif"}) {
    const Image image =
        read_image(write_image(folder / name, 1, 1, rgba, pixel, OIIO::TypeUInt8, unassociated), true);
    ASSERT_EQ(image.pixels.size(), 3u);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(image.pixels[c], pixel[c], 0.5 / 255 + 1e-6) << name;
  }
  const Image exr = read_image(write_image(folder / "a.exr", 1, 1, rgba, pixel, OIIO::TypeFloat), false);
  EXPECT_EQ(exr.pixels, (std::vector<float>{0.4f, 0.6f, 0.8f}));
}

TEST_F(Images, GreyHasOneChannel) {
  for (const char* name : {"a.png", "a.jpg", "a.tif"}) {
    const Image image = read_image(
        write_image(folder / name, 8, 8, {"Y"}, std::vector<float>(64, 0.5f), OIIO::TypeUInt8), true);
    EXPECT_EQ(image.channels, 1u) << name;
    EXPECT_NEAR(image.pixels[0], 0.5, 0.02) << name;
  }
}

TEST_F(Images, TiledAndLargeFiles) {
  // More rows than a strip, a last tile that is cut off.
  const auto values = ramp(100 * 150 * 3);
  const auto tiles = [](OIIO::ImageSpec& spec) { spec.tile_width = spec.tile_height = 32; };
  EXPECT_EQ(
      read_image(write_image(folder / "a.exr", 100, 150, kRgb, values, OIIO::TypeFloat, tiles), false).pixels,
      values);
  EXPECT_EQ(read_image(write_image(folder / "b.exr", 100, 150, kRgb, values, OIIO::TypeFloat), false).pixels,
            values);
}

TEST_F(Images, DataWindowMayBeAnywhere) {
  const auto shift = [](OIIO::ImageSpec& spec) {
    spec.x = -7;
    spec.y = 11;
  };
  expect_ramp(
      read_image(write_image(folder / "a.exr", kWidth, kHeight, kRgb, ramp(45), OIIO::TypeFloat, shift),
                 false),
      0);
}

TEST_F(Images, ExrChannelsAreChosenByName) {
  // EXR sorts channels by name: the colours come in another order, or with others between them.
  const std::vector<std::string> names = {"depth", "layer.B", "layer.G", "layer.R", "layer.A"};
  const Image image =
      read_image(write_image(folder / "a.exr", 1, 1, names, {9, 1, 2, 3, 0.5f}, OIIO::TypeFloat), false);
  EXPECT_EQ(image.pixels, (std::vector<float>{3, 2, 1}));
  const std::vector<std::string> apart = {"B", "G", "M", "Q", "R"};
  EXPECT_EQ(
      read_image(write_image(folder / "b.exr", 1, 1, apart, {1, 2, 8, 9, 3}, OIIO::TypeFloat), false).pixels,
      (std::vector<float>{3, 2, 1}));
}

TEST_F(Images, RealFiles) {
  const std::filesystem::path root = data_folder();
  if (root.empty()) return;
  for (const char* name : {"envmaps/museum.exr", "envmaps/kloppenheim_05_1k.hdr",
                           "envmaps/studio_small_03_1k.hdr", "loaders/bitmap/spot_0.exr",
                           "loaders/bitmap/spot_multi.exr", "scenes/mitsuba/matpreview/envmap.exr"}) {
    if (!std::filesystem::exists(root / name)) continue;
    const Image image = read_image(root / name, false);
    EXPECT_EQ(image.channels, 3u) << name;
    EXPECT_EQ(image.pixels.size(), size_t(image.width) * image.height * 3) << name;
  }
}

}  // namespace
}  // namespace kiloband::test
