// ENVI cubes of other programs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "cube_support.hpp"
#include "post/convert.hpp"

namespace kiloband {
namespace {

using namespace test;

/// A number that all integer types of ENVI hold.
double envi_number(std::size_t y, std::size_t x, std::size_t k) {
  return static_cast<double>(y * 25 + x * 5 + k);
}

template <class Number>
std::string envi_bytes(const std::string& interleave, bool big_endian, std::size_t offset) {
  constexpr std::size_t kLines = 3, kSamples = 4, kBands = 5;
  std::string bytes(offset, 'x');
  const auto put = [&](std::size_t y, std::size_t x, std::size_t k) {
    const auto number = static_cast<Number>(envi_number(y, x, k));
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    if (big_endian) std::reverse(raw, raw + sizeof number);
    bytes.append(raw, sizeof number);
  };
  const bool bsq = interleave == "bsq", bil = interleave == "bil";
  for (std::size_t a = 0; a < (bsq ? kBands : kLines); ++a)
    for (std::size_t b = 0; b < (bsq ? kLines : bil ? kBands : kSamples); ++b)
      for (std::size_t c = 0; c < (bsq || bil ? kSamples : kBands); ++c)
        if (bsq)
          put(b, c, a);
        else if (bil)
          put(a, c, b);
        else
          put(a, b, c);
  return bytes;
}

std::string envi_bytes_of_type(int type, const std::string& interleave, bool big, std::size_t offset) {
  switch (type) {
    case 1:
      return envi_bytes<uint8_t>(interleave, big, offset);
    case 2:
      return envi_bytes<int16_t>(interleave, big, offset);
    case 3:
      return envi_bytes<int32_t>(interleave, big, offset);
    case 4:
      return envi_bytes<float>(interleave, big, offset);
    case 5:
      return envi_bytes<double>(interleave, big, offset);
    case 12:
      return envi_bytes<uint16_t>(interleave, big, offset);
    case 13:
      return envi_bytes<uint32_t>(interleave, big, offset);
    case 14:
      return envi_bytes<int64_t>(interleave, big, offset);
    default:
      return envi_bytes<uint64_t>(interleave, big, offset);
  }
}

TEST(ForeignEnvi, EveryTypeInterleaveAndByteOrder) {
  const TemporaryFolder folder;
  for (const int type : {1, 2, 3, 4, 5, 12, 13, 14, 15})
    for (const std::string interleave : {"bsq", "BIL", "bip"})
      for (const bool big : {false, true}) {
        const std::size_t offset = big ? 7 : 0;
        folder.write("f.hdr",
                     "ENVI\nSamples=4\nlines = 3\nbands = 5\n; a comment\n\nheader offset = " +
                         std::to_string(offset) + "\ndata type = " + std::to_string(type) +
                         "\ninterleave = " + interleave + "\nbyte order = " + (big ? "1" : "0") +
                         "\nwavelength units = Micrometers\nwavelength = {0.4, 0.5,\n 0.6, 0.7, 0.8}\n");
        std::string lower = interleave == "BIL" ? "bil" : interleave;
        folder.write("f.dat", envi_bytes_of_type(type, lower, big, offset));
        const Cube cube = read_cube(folder / "f.hdr", 2);
        ASSERT_EQ(cube.mean.size(), 60u);
        for (std::size_t i = 0; i < 60; ++i)
          ASSERT_EQ(cube.mean[i], envi_number(i / 20, i / 5 % 4, i % 5)) << type << interleave << big;
        EXPECT_NEAR(cube.info.bands[0].channel.min_nm, 350, 1e-9);
        EXPECT_NEAR(cube.info.bands[0].channel.max_nm, 450, 1e-9);
      }
}

class EnviHeaderText : public testing::Test {
 protected:
  /// Opens a 1x1 image of `bands` float bands with these extra header lines.
  std::unique_ptr<CubeReader> open(std::size_t bands, const std::string& lines) {
    folder.write("f.hdr", "ENVI\nsamples = 1\nlines = 1\nbands = " + std::to_string(bands) +
                              "\ndata type = 4\ninterleave = bip\nbyte order = 0\n" + lines);
    folder.write("f", std::string(bands * 4, '\0'));  // no extension
    return open_cube(folder / "f.hdr", messages.sink());
  }
  TemporaryFolder folder;
  Messages messages;
};

TEST_F(EnviHeaderText, WidthsGiveBounds) {
  const auto cube =
      open(2, "wavelength units = nm\nwavelength = {600, 500}\nfwhm = {10, 20.5}\nkey = some text\n");
  EXPECT_EQ(cube->info().bands[0].channel.min_nm, 595);
  EXPECT_EQ(cube->info().bands[1].channel.max_nm, 510.25);
  EXPECT_EQ(cube->info().quantity, Quantity::kDensity);
  EXPECT_EQ(cube->info().metadata.at("key"), "some text");
  EXPECT_TRUE(messages.contain("does not state the quantity"));
}

TEST_F(EnviHeaderText, CentresInAnyOrderGiveMiddles) {
  const auto cube = open(3, "wavelength units = Nanometers\nwavelength = {600, 400, 500}\n");
  EXPECT_EQ(cube->info().bands[0].channel.min_nm, 550);
  EXPECT_EQ(cube->info().bands[0].channel.max_nm, 650);
  EXPECT_EQ(cube->info().bands[1].channel.min_nm, 350);
  EXPECT_EQ(cube->info().bands[2].channel.min_nm, 450);
  EXPECT_TRUE(messages.contain("half-way"));
}

TEST_F(EnviHeaderText, UnevenCentresStay) {
  const auto cube = open(4, "wavelength units = nm\nwavelength = {865, 945, 1610, 2190}\n");
  const double centres[] = {865, 945, 1610, 2190}, half_widths[] = {40, 40, 290, 290};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(cube->info().bands[k].channel.centre_nm(), centres[k]);
    EXPECT_EQ(cube->info().bands[k].channel.width_nm(), 2 * half_widths[k]);
  }
}

TEST_F(EnviHeaderText, MissingUnitsAreGuessedAloud) {
  EXPECT_EQ(open(1, "wavelength = {10.5}\nfwhm = {1}\n")->info().bands[0].channel.min_nm, 10000);
  EXPECT_TRUE(messages.contain("taken as micrometers (all are below 100)"));
  EXPECT_EQ(open(1, "wavelength = {500}\nfwhm = {10}\n")->info().bands[0].channel.min_nm, 495);
  EXPECT_TRUE(messages.contain("taken as nanometers (the largest is at least 100)"));
}

TEST_F(EnviHeaderText, BandsWithoutWavelengthsKeepTheirNames) {
  const auto cube = open(2, "band names = {grass, sand}\n");
  EXPECT_TRUE(cube->info().bands[0].derived);
  EXPECT_EQ(cube->info().bands[1].channel.name, "sand");
  EXPECT_TRUE(messages.contain("no wavelengths"));
  EXPECT_EQ(open(1, "wavelength units = Index\nwavelength = {1}\n")->info().bands[0].channel.name, "band 1");
}

TEST_F(EnviHeaderText, IgnoredValuesAreNoNumbers) {
  const auto cube = open(1, "wavelength = {500}\nfwhm = {10}\ndata ignore value = 0\n");
  float value = 1;
  cube->read_rows(0, 1, {&value, 1}, {});
  EXPECT_TRUE(std::isnan(value));
}

/// A decimal number that no float is exactly.
TEST(EnviForeign, IgnoredFloatsAreRounded) {
  const TemporaryFolder folder;
  const float values[] = {-3.4e38f, 0.1f, 1};
  folder.write("a.img", std::string(reinterpret_cast<const char*>(values), sizeof values));
  for (const auto& [ignored, at] : {std::pair{"-3.4e+38", 0}, {"0.1", 1}, {"1e300", -1}}) {
    folder.write("a.hdr", std::string("ENVI\nsamples = 3\nlines = 1\nbands = 1\ndata type = 4\ninterleave = "
                                      "bsq\nbyte order = 0\nwavelength = {500}\nfwhm = {10}\n"
                                      "data ignore value = ") +
                              ignored + "\n");
    float read[3];
    open_cube(folder / "a.hdr")->read_rows(0, 1, read, {});
    for (int x = 0; x < 3; ++x) EXPECT_EQ(std::isnan(read[x]), x == at) << ignored << " " << x;
  }
}

/// The largest numbers stand for no data, in as many digits as who wrote them likes: more than that is rounded to them, or reads as infinite.
TEST(EnviForeign, TheLargestNumbersAreIgnoredInAnySpelling) {
  const TemporaryFolder folder;
  const float floats[] = {-std::numeric_limits<float>::max(), 1};
  const double doubles[] = {-std::numeric_limits<double>::max(), 1};
  const auto first = [&](int type, const std::string& bytes, const std::string& ignored) {
    folder.write("a.img", bytes);
    folder.write("a.hdr", "ENVI\nsamples = 2\nlines = 1\nbands = 1\ndata type = " + std::to_string(type) +
                              "\ninterleave = bsq\nbyte order = 0\nwavelength = {500}\nfwhm = {10}\n" +
                              "data ignore value = " + ignored + "\n");
    float read[2];
    open_cube(folder / "a.hdr")->read_rows(0, 1, read, {});
    EXPECT_EQ(read[1], 1);
    return read[0];
  };
  const std::string as_floats(reinterpret_cast<const char*>(floats), sizeof floats),
      as_doubles(reinterpret_cast<const char*>(doubles), sizeof doubles);
  for (const char* ignored : {"-3.4028234663852886e+38", "-3.40282346638529e+38", "-3.4028235e+38"})
    EXPECT_TRUE(std::isnan(first(4, as_floats, ignored))) << ignored;
  for (const char* ignored : {"-3.4028236e+38", "-1e39", "3.4028235e+38", "-1.79769313486232e+308"})
    EXPECT_EQ(first(4, as_floats, ignored), floats[0]) << ignored;
  for (const char* ignored :
       {"-1.7976931348623157e+308", "-1.79769313486232e+308", "-1.797693134862316e+308"})
    EXPECT_TRUE(std::isnan(first(5, as_doubles, ignored))) << ignored;
  EXPECT_TRUE(std::isinf(first(5, as_doubles, "1.79769313486232e+308")));
  const float infinite[] = {-std::numeric_limits<float>::infinity(), 1};
  EXPECT_TRUE(
      std::isnan(first(4, std::string(reinterpret_cast<const char*>(infinite), sizeof infinite), "-inf")));
}

TEST_F(EnviHeaderText, BadBandsAreToldOf) {
  open(3, "wavelength = {500, 600, 700}\nbbl = {1, 1, 1}\n");
  EXPECT_FALSE(messages.contain("bbl"));
  open(3, "wavelength = {500, 600, 700}\nbbl = {1, 0, 0}\n");
  EXPECT_TRUE(messages.contain("f.hdr:9: bbl: marks 2 of 3 bands as bad: they are read like the others"));
  EXPECT_EQ(open(1, "bbl = {0}\n")->info().metadata.at("bbl"), "{0}");
}

/// Lists stay lists, so that other programs read them as before; what a list says of the bands goes with them, and it is
/// said again of a copy that its values are as they were.
TEST_F(EnviHeaderText, ListsOfOthersAreCopiedAsLists) {
  const std::string map = "map info = {UTM, 1.000, 1.000, 5, 6}", bad = "bbl = {1, 0, 1}",
                    gains = "data gain values = {1, 2, 3}";
  open(3, "wavelength = {500, 600, 700}\nwavelength units = nm\n" + map + "\n" + bad + "\n" + gains +
              "\nreflectance scale factor = 10000\nplain = a b\n");
  CubeSelection selection;
  convert_cube(folder / "f.hdr", folder / "all.hdr", selection);
  selection.bands = {2, 1};
  convert_cube(folder / "f.hdr", folder / "two.hdr", selection);
  const std::string all = folder.read("all.hdr"), two = folder.read("two.hdr");
  for (const std::string& line : {map, bad, gains, std::string("plain = a b")})
    EXPECT_NE(all.find(line + "\n"), std::string::npos) << line << all;
  for (const std::string& line : {map, std::string("bbl = {1, 0}"), std::string("data gain values = {3, 2}")})
    EXPECT_NE(two.find(line + "\n"), std::string::npos) << line << two;
  Messages copied;
  open_cube(folder / "two.hdr", copied.sink());
  EXPECT_TRUE(copied.contain("bbl: marks 1 of 2 bands as bad"));
  EXPECT_TRUE(copied.contain("data gain values: not applied"));
  EXPECT_TRUE(copied.contain("reflectance scale factor: not applied"));
  convert_cube(folder / "f.hdr", folder / "two.exr", selection);
  Messages as_exr;
  open_cube(folder / "two.exr", as_exr.sink());
  EXPECT_TRUE(as_exr.contain("'data gain values': not applied"));
  EXPECT_TRUE(as_exr.contain("'reflectance scale factor': not applied"));
  selection.bands = {};
  selection.rebin = ChannelList{{450, 650, ""}};
  convert_cube(folder / "f.hdr", folder / "sum.hdr", selection);
  for (const char* key : {"bbl", "data gain values"})
    EXPECT_EQ(folder.read("sum.hdr").find(key), std::string::npos);
}

TEST_F(EnviHeaderText, CalibrationsAreNotAppliedAloud) {
  open(1, "wavelength = {500}\nfwhm = {10}\ndata gain values = {2}\nreflectance scale factor = 10000\n");
  EXPECT_TRUE(messages.contain("data gain values: not applied"));
  EXPECT_TRUE(messages.contain("reflectance scale factor: not applied"));
  EXPECT_NO_THROW(open(1, "file compression = 0\n"));
  EXPECT_THROW(open(1, "file compression = 1\n"), InputError);
}

TEST_F(EnviHeaderText, ReflectanceCalibrationsAreNotAppliedAloud) {
  open(1, "data reflectance gain values = {2}\ndata reflectance offset values = {1}\n");
  EXPECT_TRUE(messages.contain("data reflectance gain values: not applied"));
  EXPECT_TRUE(messages.contain("data reflectance offset values: not applied"));
}

/// They are of the file and not of its copy.
TEST_F(EnviHeaderText, FrameOffsetsOfZeroAreNotCopied) {
  open(1, "wavelength = {500}\nmajor frame offsets = {0, 0}\nminor frame offsets = 0\n");
  convert_cube(folder / "f.hdr", folder / "g.hdr", {});
  EXPECT_EQ(folder.read("g.hdr").find("frame offsets"), std::string::npos);
}

TEST_F(EnviHeaderText, EveryListOfTheBandsGoesWithThem) {
  open(3,
       "wavelength = {500, 600, 700}\nwavelength units = nm\ndata reflectance gain values = {1, 2, 3}\n"
       "Data Reflectance Offset Values = {4, 5, 6}\nsolar irradiance = {7, 8, 9}\n"
       "spectra names = {a, b, c}\n");
  CubeSelection selection;
  selection.bands = {2, 0};
  convert_cube(folder / "f.hdr", folder / "two.hdr", selection);
  const std::string two = folder.read("two.hdr");
  for (const char* line :
       {"data reflectance gain values = {3, 1}\n", "Data Reflectance Offset Values = {6, 4}\n",
        "solar irradiance = {9, 7}\n", "spectra names = {a, b, c}\n"})
    EXPECT_NE(two.find(line), std::string::npos) << line << two;
}

/// 1000 * 1.005 is a little less than 1005.
TEST_F(EnviHeaderText, MicrometresBecomeTheNanometresThatAreMeant) {
  const std::string units = "wavelength units = Micrometers\nwavelength = {1.005, 0.3001}\n";
  const auto cube = open(2, units + "fwhm = {0.0101, 0.0002}\n");
  EXPECT_EQ(cube->info().bands[0].channel.min_nm, 999.95);
  EXPECT_EQ(cube->info().bands[0].channel.max_nm, 1010.05);
  EXPECT_EQ(cube->info().bands[1].channel.min_nm, 300);
  EXPECT_EQ(cube->info().bands[1].channel.max_nm, 300.2);
  EXPECT_EQ(open(1, "wavelength units = um\nwavelength = {1.005}\n")->info().bands[0].channel.min_nm, 1004.5);
}

/// Cameras and DOS write names in capitals; a cube of the same name in small letters is another.
TEST(ForeignEnvi, NamesInCapitals) {
  const TemporaryFolder folder;
  const std::string header =
      "ENVI\nsamples = 1\nlines = 1\nbands = 1\ndata type = 1\ninterleave = bsq\nbyte order = 0\n";
  const auto value = [&](const char* name) { return read_cube(folder / name).mean.at(0); };
  folder.write("UP.HDR", header);
  EXPECT_EQ(error_of(folder, [&] { open_cube(folder / "UP.HDR"); }),
            "'UP.HDR': no data file 'UP.IMG' beside it");
  folder.write("UP.IMG", "\1");
  EXPECT_EQ(value("UP.HDR"), 1);
  EXPECT_EQ(value("UP.IMG"), 1);
  EXPECT_EQ(cube_files(folder / "UP.IMG"),
            (std::vector{folder / "UP.IMG", folder / "UP.HDR", folder / "UP.IMG"}));
  folder.write("UP.img", "\2");
  folder.write("UP.hdr", header);
  EXPECT_EQ(value("UP.HDR"), 1);
  EXPECT_EQ(value("UP.hdr"), 2);
  EXPECT_EQ(value("UP.img"), 2);
  folder.write("MIX.HDR", header);
  folder.write("MIX.img", "\3");
  EXPECT_EQ(value("MIX.HDR"), 3);
  EXPECT_EQ(value("MIX.img"), 3);
  folder.write("RAW.HDR", header);
  folder.write("RAW.BIL", "\4");
  EXPECT_EQ(value("RAW.HDR"), 4);
}

/// 3.4028235e38 is more than the largest float and nearer to it than to the next power of two.
TEST(ForeignEnvi, DoublesAreRoundedToFloats) {
  const TemporaryFolder folder;
  constexpr float kLargest = std::numeric_limits<float>::max();
  const double doubles[] = {3.4028235e38, -3.4028235e38, 0x1.ffffffp127, -1e300, NAN};
  folder.write("a.img", std::string(reinterpret_cast<const char*>(doubles), sizeof doubles));
  folder.write("a.hdr",
               "ENVI\nsamples = 5\nlines = 1\nbands = 1\ndata type = 5\ninterleave = bsq\nbyte "
               "order = 0\nwavelength = {500}\nfwhm = {10}\n");
  const std::vector<float> read = read_cube(folder / "a.hdr").mean;
  EXPECT_EQ(read[0], kLargest);
  EXPECT_EQ(read[1], -kLargest);
  EXPECT_EQ(read[2], INFINITY);
  EXPECT_EQ(read[3], -INFINITY);
  EXPECT_TRUE(std::isnan(read[4]));
}

}  // namespace
}  // namespace kiloband
