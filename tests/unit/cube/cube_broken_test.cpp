// Broken cubes, each with the message that its user sees.
#include <gtest/gtest.h>

#include <cstring>

#include "cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

constexpr char kGoodHeader[] =
    "ENVI\nsamples = 2\nlines = 3\nbands = 2\ndata type = 4\ninterleave = bsq\nbyte order = 0\n"
    "wavelength units = Nanometers\nwavelength = {500, 600}\nfwhm = {10, 10}\n";

/// The good header with one text replaced by another.
std::string with(const std::string& from, const std::string& to) {
  std::string header = kGoodHeader;
  return header.replace(header.find(from), from.size(), to);
}

TEST(BrokenEnvi, Messages) {
  const struct {
    std::string header, message;  // the message behind the path of the header
  } cases[] = {
      {"", ":1: not an ENVI header: the first line must be 'ENVI'"},
      {"ENVY\n", ":1: not an ENVI header: the first line must be 'ENVI'"},
      {with("bands = 2", "bands"), ":4: 'bands': expected 'key = value'"},
      {with("{10, 10}", "{10, 10"), ":10: fwhm: '{' without '}'"},
      {with("samples = 2\n", ""), ": 'samples' is missing"},
      {with("samples = 2", "samples = -2"), ":2: samples '-2': must be a whole number, at most 1048576"},
      {with("lines = 3", "lines = 0"), ":3: lines '0': must be at least 1"},
      {with("bands = 2", "bands = 2000000"), ":4: bands '2000000': must be a whole number, at most 1048576"},
      {with("data type = 4\n", ""), ": 'data type' is missing"},
      {with("data type = 4", "data type = 6"),
       ":5: data type '6': must be 1, 2, 3, 4, 5, 12, 13, 14 or 15 (real numbers)"},
      {with("interleave = bsq\n", ""), ": 'interleave' is missing"},
      {with("bsq", "bqs"), ":6: interleave 'bqs': must be bsq, bil or bip"},
      {with("byte order = 0", "byte order = 2"), ":7: byte order '2': must be a whole number, at most 1"},
      {with("Nanometers", "Furlongs"), ":8: wavelength units 'Furlongs': must be Nanometers or Micrometers"},
      {with("{500, 600}", "{500}"), ":9: wavelength: 1 entries for 2 bands"},
      {with("{500, 600}", "{500,\n x}"), ":9: wavelength: 'x' is not a number"},
      {with("{500, 600}", "{500, nan}"), ":9: wavelength: 'nan' is not a number"},
      {with("{10, 10}", "{10, 0}"),
       ":10: fwhm: band 1 of width 0 nm at 600 nm: must be positive and end above 0 nm"},
      {with("fwhm = {10, 10}\n", "")
           .replace(std::string(with("fwhm = {10, 10}\n", "")).find("600"), 3, "500"),
       ":9: wavelength: band centre 500 nm: intervals can only follow from centres that are distinct and "
       "positive"},
      {with("fwhm", "kiloband quantity = radiance\nfwhm"),
       ":10: kiloband quantity 'radiance': must be integral or density"},
      {with("fwhm", "kiloband band minimum = {500, 700}\nkiloband band maximum = {510, 650}\nfwhm"),
       ": band 1: interval 700-650 nm: must be positive and ascending"},
      {with("fwhm", "kiloband band minimum = {500, 700}\nfwhm"), ": 'kiloband band maximum' is missing"},
      {with("fwhm", "major frame offsets = {8, 0}\nfwhm"),
       ":10: major frame offsets '8, 0': must be 0: images with bytes between their frames are not read"},
      {with("fwhm", "Minor Frame Offsets = {0, none}\nfwhm"),
       ":10: Minor Frame Offsets '0, none': must be 0: images with bytes between their frames are not read"},
      {with("fwhm", "kiloband layout = 2\nfwhm"),
       ":10: kiloband layout '2': must be 1: the file was written by a newer kiloband, take that one to read it"},
      {with("fwhm", "kiloband layout = new\nfwhm"), ":10: kiloband layout 'new': must be 1"},
      {with("fwhm", "data ignore value = none\nfwhm"), ":10: data ignore value 'none': must be a number"},
      {with("{500, 600}", "{500, 6\x01\xFF}"), ":9: wavelength: '6\\x01\\xFF' is not a number"},
  };
  const TemporaryFolder folder;
  folder.write("f.img", std::string(2 * 3 * 2 * 4, '\0'));
  for (const auto& broken : cases) {
    folder.write("f.hdr", broken.header);
    EXPECT_EQ(error_of([&] { open_cube(folder / "f.hdr"); }), (folder / "f.hdr").string() + broken.message)
        << broken.header;
  }
  folder.write("f.hdr", kGoodHeader);
  EXPECT_EQ(read_cube(folder / "f.hdr").mean.size(), 12u);
}

TEST(BrokenEnvi, FilesThatAreMissingOrShort) {
  const TemporaryFolder folder;
  const std::string base = (folder / "f").string();
  const auto error = [&](const char* name) { return error_of([&] { open_cube(folder / name); }); };
  EXPECT_EQ(error("f.hdr"), "cannot open '" + base + ".hdr': No such file or directory");
  EXPECT_EQ(error("f.img"), "'" + base + ".img': no header 'f.hdr' or 'f.img.hdr' beside it");
  EXPECT_EQ(error("f.tif"),
            "'" + base + ".tif': cannot tell the format of a cube: must end in .exr, .hdr or .img (ENVI)");
  folder.write("f.hdr", kGoodHeader);
  EXPECT_EQ(error("f.hdr"), "'" + base + ".hdr': no data file 'f.img' beside it");
  folder.write("f.img", std::string(47, '\0'));
  EXPECT_EQ(error("f.hdr"), base + ".img: the file has 47 bytes, its header needs 48");
  folder.write("f.hdr", with("bands = 2", "header offset = 4\nbands = 2"));
  EXPECT_EQ(error("f.hdr"), base + ".img: the file has 47 bytes, its header needs 52");
  std::filesystem::remove(folder / "f.hdr");
  std::filesystem::create_directory(folder / "f.hdr");
  EXPECT_EQ(error("f.hdr"), "cannot open '" + base + ".hdr': not a regular file");
  EXPECT_EQ(error_of([&] {
              create_cube_writer(folder / "f.tif", make_cube(1, 1, equal_bands(400, 500, 1)).info, 1);
            }),
            "'" + base + ".tif': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)");
}

/// In our own files nothing stands behind the numbers: a header of a smaller cube is not theirs.
TEST(BrokenEnvi, DataThatAreLongerThanTheirHeaderSays) {
  const TemporaryFolder folder;
  const std::string reason = " bytes, its header says 48: it belongs to another header, or is damaged";
  for (const char* part : {"f.img", "f.var.img"}) {
    write_cube_file(make_cube(2, 3, equal_bands(400, 500, 2), true), folder / "f.hdr");
    std::filesystem::resize_file(folder / part, 52);
    EXPECT_EQ(error_of([&] { open_cube(folder / "f.hdr"); }),
              (folder / part).string() + ": the file has 52" + reason);
  }
  folder.write("f.hdr", kGoodHeader);  // another program's
  Messages messages;
  EXPECT_EQ(open_cube(folder / "f.hdr", messages.sink())->info().width, 2u);
  EXPECT_FALSE(messages.contain("bytes"));
  std::filesystem::resize_file(folder / "f.img", 50);
  open_cube(folder / "f.hdr", messages.sink());
  EXPECT_TRUE(messages.contain("the file has 50 bytes, its header says 48: the rest is ignored"));
}

class BrokenExr : public testing::Test {
 protected:
  void SetUp() override {
    write_cube_file(make_cube(40, 40, equal_bands(400, 500, 3)), file);
    good = read_file(file);
  }
  std::string error(const std::string& bytes) {
    return error_of([&] { read_cube(folder.write("f.exr", bytes)); });
  }
  /// The good file with the little-endian number at `at` replaced.
  std::string with_number(std::size_t at, uint32_t number) const {
    std::string bytes = good;
    for (std::size_t b = 0; b < 4; ++b) bytes[at + b] = static_cast<char>(number >> (8 * b));
    return bytes;
  }
  /// Offset of an attribute's value, behind name, type and size.
  std::size_t value_of(const std::string& name, const std::string& type) const {
    return good.find(name + '\0' + type + '\0') + name.size() + type.size() + 2 + 4;
  }
  TemporaryFolder folder;
  std::filesystem::path file = folder / "f.exr";
  std::string where = (folder / "f.exr").string();
  std::string good;
};

TEST_F(BrokenExr, Messages) {
  const std::string damaged = where + ": not a readable EXR file: ";
  EXPECT_EQ(error(good), "accepted");
  EXPECT_EQ(error(""), damaged + "the file ends too early");
  EXPECT_EQ(error("v/1"), damaged + "the file ends too early");
  EXPECT_EQ(error("PNG and something more"), damaged + "it does not begin as one");
  EXPECT_EQ(error(good.substr(0, 200)), damaged + "an attribute is larger than the file");
  EXPECT_EQ(error(good.substr(0, good.size() - 1)),
            where + ": the EXR file is incomplete: it ends before its last pixels");
  EXPECT_EQ(error(good.substr(0, good.size() / 2)), damaged + "the file is too small for its image");
  EXPECT_EQ(error(with_number(4, 0x1002)), where + ": deep and multi-part EXR files cannot be read as cubes");
  const std::size_t window = value_of("dataWindow", "box2i"), tiles = value_of("tiles", "tiledesc");
  EXPECT_EQ(error(with_number(window + 8, 0x7FFFFFFF)),
            where + ": image size 2147483648x40: must be between 1 and 1048576");
  EXPECT_EQ(error(with_number(window + 8, static_cast<uint32_t>(-5))),
            where + ": image size -4x40: must be between 1 and 1048576");
  EXPECT_EQ(error(with_number(window + 8, 1000000)), damaged + "the file is too small for its image");
  EXPECT_EQ(error(with_number(tiles, 0)), damaged + "tiles without pixels");
  EXPECT_EQ(error(with_number(tiles, 0x7FFFFFFF)), damaged + "tiles or blocks of lines are too large");
  EXPECT_EQ(error(with_number(window - 4, 0x7FFFFFFF)), damaged + "an attribute is larger than the file");
  // Four bytes that are no part of a box of integers would be read as the next attribute's name.
  std::string longer = with_number(window - 4, 20);
  longer.insert(window + 16, "name");
  EXPECT_EQ(error(longer), damaged + "attribute 'dataWindow' does not have the size that it states");
  // In the channel list a name is followed by its type (2: FLOAT), a flag and the two sampling rates.
  const std::size_t channel = good.find(std::string("S0.416,666667nm\0\2\0\0\0", 20));
  ASSERT_NE(channel, std::string::npos);
  EXPECT_EQ(error(with_number(channel + 16 + 8, 2)),
            where + ": channel 'S0.416,666667nm' is subsampled, which cubes are not");
}

TEST_F(BrokenExr, AChunkThatWasNeverWritten) {
  // The table of offsets stands behind the header; its first entry points behind the table's four entries.
  std::string bytes = good;
  for (std::size_t at = 0; at + 8 < bytes.size(); ++at) {
    uint64_t offset = 0;
    std::memcpy(&offset, bytes.data() + at, 8);
    if (offset != at + 32) continue;
    std::memset(bytes.data() + at + 8, 0, 8);
    EXPECT_EQ(error(bytes), where + ": the EXR file is incomplete: parts of the image were never written");
    return;
  }
  FAIL() << "no table of offsets";
}

TEST(BrokenInfo, WhatNoFileCanHoldIsRefusedBeforeWriting) {
  const TemporaryFolder folder;
  const auto file = folder / "f.exr";
  const auto error = [&](const std::function<void(CubeInfo&)>& damage) {
    CubeInfo info = make_cube(2, 2, equal_bands(400, 500, 2), false, {"depth.Z"}).info;
    damage(info);
    const std::string text = error_of([&] { create_cube_writer(file, info, 32); });
    return text.starts_with(file.string() + ": ") ? text.substr(file.string().size() + 2) : text;
  };
  EXPECT_EQ(error([](CubeInfo& i) { i.width = 0; }), "image size 0x2: must be between 1 and 1048576");
  EXPECT_EQ(error([](CubeInfo& i) { i.bands.clear(); }), "0 bands: must be between 1 and 1048576");
  EXPECT_EQ(error([](CubeInfo& i) { i.bands[1].channel.max_nm = 300; }),
            "band 1: interval 450-300 nm: must be positive and ascending");
  EXPECT_EQ(error([](CubeInfo& i) { i.bands[0].channel.min_nm = 0.0 / 0.0; }),
            "band 0: wavelengths must be finite");
  EXPECT_EQ(error([](CubeInfo& i) { i.bands[0].derived = true; }), "band 0: a derived band must have a name");
  EXPECT_EQ(error([](CubeInfo& i) { i.bands[0].channel.name = "a\nb"; }),
            "band 0 'a\\x0Ab': contains a control character");
  EXPECT_EQ(error([](CubeInfo& i) { i.bands[0].channel.name.assign(201, 'x'); }),
            "band 0 '" + std::string(80, 'x') + "...': longer than 200 bytes");
  EXPECT_EQ(error([](CubeInfo& i) { i.aux.push_back("depth.Z"); }), "auxiliary plane 'depth.Z': given twice");
  EXPECT_EQ(error([](CubeInfo& i) { i.aux.push_back(""); }), "an auxiliary plane must have a name");
  EXPECT_EQ(error([](CubeInfo& i) { i.metadata[""] = "x"; }), "metadata name '': must have 1 to 200 bytes");
  EXPECT_TRUE(folder.list().empty());
}

}  // namespace
}  // namespace kiloband
