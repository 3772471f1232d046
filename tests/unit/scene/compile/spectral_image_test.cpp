// Reading images of spectra and of weights.
#include "scene/image/spectral_image.hpp"

#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::spectral_image_test {
namespace {

double sample(uint32_t x, uint32_t y, std::size_t b) {
  return 1 + x + 10 * y + 100 * static_cast<double>(b);
}

/// Both formats and quantities give densities, by ascending wavelength whatever the order in the file.
TEST(SpectralImage, BandsComeAsDensitiesInAscendingOrder) {
  const TemporaryFolder folder;
  const ChannelList bands{{600, 650, ""}, {400, 404, ""}, {500, 510, ""}};
  for (const char* name : {"a.exr", "a.hdr"}) {
    for (const Quantity quantity : {Quantity::kDensity, Quantity::kIntegral}) {
      write_cube(folder / name, 3, 40, bands, sample, quantity);  // 40 rows: more than are read at once
      const SpectralImage image = read_spectral_image(folder / name, {});
      ASSERT_EQ(image.width, 3u);
      ASSERT_EQ(image.height, 40u);
      ASSERT_EQ(image.values_per_pixel, 3u);
      EXPECT_EQ(image.bands[0].min_nm, 400);
      EXPECT_EQ(image.bands[2].max_nm, 650);
      const std::size_t order[] = {1, 2, 0};
      for (uint32_t y = 0; y < 40; ++y)
        for (uint32_t x = 0; x < 3; ++x)
          for (std::size_t b = 0; b < 3; ++b) {
            const double expected = sample(x, y, order[b]);
            ASSERT_NEAR((*image.values)[(y * 3 + x) * 3 + b], expected, 2e-7 * expected) << name;
          }
    }
  }
}

TEST(SpectralImage, WeightsAreTakenAsTheyAre) {
  const TemporaryFolder folder;
  folder.write("w.pgm", "P2\n2 1\n255\n51 255\n");
  const SpectralImage grey = read_weight_image(folder / "w.pgm", {});
  EXPECT_EQ(grey.values_per_pixel, 1u);
  EXPECT_FLOAT_EQ((*grey.values)[0], 0.2f);  // not decoded from sRGB
  EXPECT_TRUE(grey.bands.empty());
  folder.write("names.hdr",
               "ENVI\nsamples = 2\nlines = 1\nbands = 2\ndata type = 1\ninterleave = bip\nbyte order = 0\n"
               "band names = {soil, grass}\n");
  folder.write("names.img", std::string("\x01\x02\x03\x04"));
  const SpectralImage named = read_weight_image(folder / "names.hdr", {});
  EXPECT_EQ(*named.values, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(named.values_per_pixel, 2u);
}

/// A Radiance picture has the extension of an ENVI header.
TEST(SpectralImage, WeightsFromARadiancePicture) {
  const TemporaryFolder folder;
  folder.write("w.hdr",
               std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n") + "\x80\x40\x20\x80");
  const SpectralImage image = read_weight_image(folder / "w.hdr", {});
  ASSERT_EQ(image.values_per_pixel, 3u);
  EXPECT_NEAR((*image.values)[0], 0.5, 0.01);
  EXPECT_NEAR((*image.values)[2], 0.125, 0.01);
}

}  // namespace
}  // namespace kiloband::test::spectral_image_test
