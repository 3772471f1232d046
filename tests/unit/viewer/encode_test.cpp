#include "viewer/display/encode.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "pictures/picture_library.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;

Picture8 gradient(uint32_t width, uint32_t height) {
  Picture8 picture{width, height, {}};
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (const uint32_t v : {x * 255 / width, y * 255 / height, (x + y) * 127 / (width + height)})
        picture.rgb.push_back(static_cast<uint8_t>(v));
  return picture;
}

/// Decoded by another library: bytes 0 to 255.
std::vector<int> decode(const std::string& format, const std::string& bytes, const Picture8& like) {
  const TemporaryFolder folder;
  std::string error;
  const auto input = picture_library().open(format, folder.write("picture", bytes).string(), error);
  if (!input) throw std::runtime_error(error);
  EXPECT_EQ(input->spec().width, static_cast<int>(like.width));
  EXPECT_EQ(input->spec().height, static_cast<int>(like.height));
  std::vector<float> values(like.rgb.size());
  EXPECT_TRUE(input->read(0, static_cast<int>(like.height), 0, 3, values.data()));
  std::vector<int> out;
  for (const float v : values) out.push_back(static_cast<int>(v * 255 + 0.5f));
  return out;
}

TEST(EncodePng, KeepsEveryByte) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, std::pair{37u, 5u}, std::pair{300u, 200u}}) {
    const Picture8 picture = gradient(width, height);
    EXPECT_EQ(decode("png", encode_png(picture), picture),
              std::vector<int>(picture.rgb.begin(), picture.rgb.end()));
  }
}

TEST(EncodeJpeg, HasTheSizesThatFit) {
  for (const uint32_t width : {65500u, 65501u}) {
    const Picture8 line{width, 1, std::vector<uint8_t>(3 * width)};
    EXPECT_EQ(fits_jpeg(line), width == 65500);
    if (fits_jpeg(line))
      EXPECT_NE(encode_jpeg(line), "");
    else
      EXPECT_THROW(encode_jpeg(line), DeviceError);
  }
}

TEST(EncodeJpeg, IsNear) {
  const Picture8 picture = gradient(300, 200);
  const std::string bytes = encode_jpeg(picture);
  EXPECT_LT(bytes.size(), picture.rgb.size() / 8);
  const std::vector<int> decoded = decode("jpeg", bytes, picture);
  for (std::size_t i = 0; i < decoded.size(); ++i) ASSERT_LE(std::abs(decoded[i] - picture.rgb[i]), 6);
}

}  // namespace
}  // namespace kiloband::test
