// The rules that need no image library: which channels are taken, which files are looked at.
#include <gtest/gtest.h>

#include "image_support.hpp"
#include "scene/image/channels.hpp"
#include "scene/image/format.hpp"

namespace kiloband::test {
namespace {

std::vector<int> chosen(const std::vector<std::string>& names, int alpha = -1) {
  const ImageChannels choice = choose_channels(names, alpha);
  return {choice.index.begin(), choice.index.begin() + choice.count};
}

TEST(ImageRules, Channels) {
  EXPECT_EQ(chosen({"R", "G", "B"}), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(chosen({"A", "B", "G", "R"}, 0), (std::vector<int>{3, 2, 1}));
  EXPECT_EQ(chosen({"Y"}), (std::vector<int>{0}));
  EXPECT_EQ(chosen({"A", "Y"}, 0), (std::vector<int>{1}));
  EXPECT_EQ(chosen({"Z", "temperature", "Y"}), (std::vector<int>{}));  // could be X Y Z
  EXPECT_EQ(chosen({"X", "Y", "Z"}), (std::vector<int>{}));
  EXPECT_EQ(chosen({"a.R", "b.R", "b.G", "b.B"}), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(chosen({"temperature"}), (std::vector<int>{0}));
  EXPECT_EQ(chosen({"A", "temperature"}, 0), (std::vector<int>{1}));
  EXPECT_EQ(chosen({"S0.400nm", "S0.500nm"}), (std::vector<int>{}));
  EXPECT_EQ(chosen({}), (std::vector<int>{}));
  EXPECT_EQ(chosen({"A"}, 0), (std::vector<int>{}));
}

TEST(ImageRules, BandsOfSpectralFiles) {
  for (const char* name : {"S0.550,000000nm", "T.0,55um", "S0.5e14Hz"}) EXPECT_TRUE(has_spectra({"R", name}));
  for (const char* name : {"R", "T", "T.R", "S1.550,0nm", "response.S0.550nm", "depth.Z"})
    EXPECT_FALSE(has_spectra({name}));
}

TEST(ImageRules, FormatsAreToldByTheirFirstBytes) {
  const TemporaryFolder folder;
  const auto format = [&](const std::string& start) {
    return examine_image(folder.write("a.tga", start)).format;
  };
  EXPECT_EQ(format("\x76\x2f\x31\x01..."), ImageFormat::kExr);
  EXPECT_EQ(format("#?RADIANCE\n"), ImageFormat::kHdr);
  EXPECT_EQ(format("\x89PNG\r\n\x1a\n" + std::string("\0\0\0\0IEND\xae\x42\x60\x82", 12)), ImageFormat::kPng);
  EXPECT_EQ(format(std::string("MM\0*", 4)), ImageFormat::kTiff);
  EXPECT_EQ(format("PF\n"), ImageFormat::kPnm);
  EXPECT_EQ(format("whatever"), ImageFormat::kTarga);
}

TEST(ImageRules, Sizes) {
  const TemporaryFolder folder;
  const auto error = [&](ImageFormat format, int64_t width, int64_t height) {
    return error_of(folder, [&] { check_image_size({"a", 1000, format}, width, height); });
  };
  EXPECT_EQ(error(ImageFormat::kExr, 65535, 65535), "accepted");
  EXPECT_EQ(error(ImageFormat::kExr, 65536, 1), "a: 65536 x 1 pixels: each dimension must be in 1..65535");
  EXPECT_EQ(error(ImageFormat::kExr, 1, 65536), "a: 1 x 65536 pixels: each dimension must be in 1..65535");
  EXPECT_EQ(error(ImageFormat::kExr, 0, 1), "a: 0 x 1 pixels: each dimension must be in 1..65535");
  EXPECT_EQ(error(ImageFormat::kExr, 1, -5), "a: 1 x -5 pixels: each dimension must be in 1..65535");
  EXPECT_EQ(error(ImageFormat::kPng, 2000, 4000), "accepted");
  EXPECT_EQ(error(ImageFormat::kPng, 60000, 60000), "a: 60000 x 60000 pixels cannot be stored in 1000 bytes");
  EXPECT_EQ(error(ImageFormat::kJpeg, 60000, 60000),
            "a: 60000 x 60000 pixels cannot be stored in 1000 bytes");
}

}  // namespace
}  // namespace kiloband::test
