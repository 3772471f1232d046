// Files that are wrong, in the words of the program's own readers; what Radiance files may be besides what OpenImageIO reads.
#include <gtest/gtest.h>

#include "pictures/readers/readers.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {
namespace {

struct OwnReaders : testing::Test {
  TemporaryFolder folder;

  /// What is wrong with it, opened or read.
  std::string error(const std::string& format, const std::string& bytes) {
    std::string text;
    const auto input = picture_library().open(format, folder.write("picture", bytes), text);
    if (!input) return "open: " + text;
    std::vector<float> values(static_cast<std::size_t>(input->spec().width * input->spec().height) *
                              input->spec().channels.size());
    if (input->read(0, input->spec().height, 0, static_cast<int>(input->spec().channels.size()),
                    values.data()))
      return "";
    return "read: " + input->error();
  }

  std::vector<float> pixels(const std::string& bytes, int width, int height) {
    const auto input = open_radiance(folder.write("picture", bytes));
    EXPECT_EQ(input->spec().width, width);
    EXPECT_EQ(input->spec().height, height);
    std::vector<float> values(static_cast<std::size_t>(width * height) * 3);
    EXPECT_TRUE(input->read(0, height, 0, 3, values.data())) << input->error();
    return values;
  }
};

const std::string kHead = "#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n";

TEST_F(OwnReaders, RadianceThatIsDamaged) {
  EXPECT_EQ(error("hdr", "#?RADIANCE\n"), "open: the header ends too early");
  EXPECT_EQ(error("hdr", "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"),
            "open: pixels must be 32-bit_rle_rgbe, not '32-bit_rle_xyze'");
  EXPECT_EQ(error("hdr", kHead + "-Y a +X 1\n"), "open: '-Y a +X 1' is no size");
  EXPECT_EQ(error("hdr", kHead + "+Y 1 +X 1\nabcd"),
            "open: rows must run from the top, left to right (-Y H +X W), not '+Y 1 +X 1'");
  EXPECT_EQ(error("hdr", kHead + "-Y 2 +X 1\nabcd"), "read: the data of row 1 is damaged or truncated");
  const std::string row("\x02\x02\x00\x08", 4);
  EXPECT_EQ(error("hdr", kHead + "-Y 1 +X 8\n" + row + std::string("\x89\x01", 2)),
            "read: the data of row 0 is damaged or truncated");  // a run longer than the row
  EXPECT_EQ(error("hdr", kHead + "-Y 1 +X 9\n" + row), "read: the data of row 0 is damaged or truncated");
  EXPECT_EQ(error("hdr", "#?RADIANCE\n" + std::string(5000, 'a')), "open: a line of the header is too long");
}

/// Runs of whole pixels, of older programs: 1 1 1 n repeats the pixel before, the next such counts 256 times as much.
TEST_F(OwnReaders, RadianceWithOldRunLengths) {
  const std::string pixel("\x80\x40\x20\x81", 4), other("\x80\x80\x80\x82", 4);
  const std::vector<float> a =
      pixels(kHead + "-Y 1 +X 5\n" + pixel + std::string("\x01\x01\x01\x03", 4) + other, 5, 1);
  const std::vector<float> one = {1, 0.5f, 0.25f};
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(a[i], one[i % 3]) << i;
  for (std::size_t i = 12; i < 15; ++i) EXPECT_EQ(a[i], 2);
  const std::vector<float> b = pixels(
      kHead + "-Y 1 +X 260\n" + pixel + std::string("\x01\x01\x01\x02\x01\x01\x01\x01", 8) + other, 260, 1);
  EXPECT_EQ(b[258 * 3 + 2], 0.25f);
  EXPECT_EQ(b[259 * 3 + 2], 2);
  EXPECT_EQ(error("hdr", kHead + "-Y 1 +X 5\n" + pixel + std::string("\x01\x01\x01\x05", 4)),
            "read: the data of row 0 is damaged or truncated");
}

TEST_F(OwnReaders, PfmThatIsDamaged) {
  EXPECT_EQ(error("pnm", "PF\n1"), "open: the header ends too early");
  EXPECT_EQ(error("pnm", "PF\nx 1\n-1\n"), "open: 'x' is no size");
  EXPECT_EQ(error("pnm", "PF\n1 1\n0\n"), "open: '0' is no scale");
  EXPECT_EQ(error("pnm", "PF\n1 1\nnan\n"), "open: 'nan' is no scale");
  EXPECT_EQ(error("pnm", "PF\n1 1\n-1\nabcd"), "read: the data is truncated");
}

TEST_F(OwnReaders, PnmThatIsDamaged) {
  EXPECT_EQ(error("pnm", "P6\n1"), "open: the data is truncated");
  EXPECT_EQ(error("pnm", "P6\n1 x 255\n"), "open: 'x' is not a size between 0 and 2147483647");
  EXPECT_EQ(error("pnm", "P6\n1 1\n65536\nabc"), "open: '65536' is not a largest value between 0 and 65535");
  EXPECT_EQ(error("pnm", "P6\n1 1\n0\nabc"), "open: the largest value is 0");
  EXPECT_EQ(error("pnm", "P6\n1 2\n255\nabcde"), "read: the data is truncated");
  EXPECT_EQ(error("pnm", "P5\n1 1\n96\na"), "read: the value 97 is above the largest, 96");
  EXPECT_EQ(error("pnm", "P2\n2 1\n9\n9 10"), "read: '10' is not a value between 0 and 9");
  EXPECT_EQ(error("pnm", "P2\n2 1\n9\n9 # 1\n"), "read: the data is truncated");
}

TEST_F(OwnReaders, PngJpegAndExrThatAreDamaged) {
  const std::vector<uint8_t> rgb(40 * 30 * 3, 77);
  std::string png = png_file(40, 30, rgb.data());
  EXPECT_EQ(error("png", png), "");
  EXPECT_EQ(error("png", png.substr(0, 20)), "open: Read Error");
  const std::size_t sum = png.find("IEND") - 8;  // the data's checksum, read after the last row
  png[sum] = static_cast<char>(png[sum] ^ 1);
  EXPECT_EQ(error("png", png), "read: IDAT: CRC error");
  EXPECT_EQ(error("jpeg", "\xff\xd8\xff\xd9"), "open: JPEG datastream contains no image");
  EXPECT_EQ(error("openexr", "v/1\1abc").substr(0, 6), "open: ");
}

TEST_F(OwnReaders, FilesThatAreNotThere) {
  std::string text;
  for (const char* format : {"png", "jpeg", "hdr", "pnm"}) {
    EXPECT_FALSE(picture_library().open(format, folder / "none", text));
    EXPECT_EQ(text, "cannot be opened") << format;
  }
}

}  // namespace
}  // namespace kiloband::test
