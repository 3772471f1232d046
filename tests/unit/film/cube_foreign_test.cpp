// Cubes of other programs.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

struct Messages {
  std::vector<std::string> texts;
  DiagnosticSink sink() {
    return [this](const Diagnostic& d) { texts.push_back(d.message); };
  }
  bool contain(const std::string& part) const {
    for (const std::string& text : texts)
      if (text.find(part) != std::string::npos) return true;
    return false;
  }
};

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
        write_file(folder / "f.hdr",
                   "ENVI\nSamples=4\nlines = 3\nbands = 5\n; a comment\n\nheader offset = " +
                       std::to_string(offset) + "\ndata type = " + std::to_string(type) +
                       "\ninterleave = " + interleave + "\nbyte order = " + (big ? "1" : "0") +
                       "\nwavelength units = Micrometers\nwavelength = {0.4, 0.5,\n 0.6, 0.7, 0.8}\n");
        std::string lower = interleave == "BIL" ? "bil" : interleave;
        write_file(folder / "f.dat", envi_bytes_of_type(type, lower, big, offset));
        const Cube cube = read_cube_file(folder / "f.hdr", 2);
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
    write_file(folder / "f.hdr", "ENVI\nsamples = 1\nlines = 1\nbands = " + std::to_string(bands) +
                                     "\ndata type = 4\ninterleave = bip\nbyte order = 0\n" + lines);
    write_file(folder / "f", std::string(bands * 4, '\0'));  // no extension
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

// ---- EXR ----

/// Writes channels of one pixel row pattern: value of channel c at (x, y) is 100 c + 10 y + x.
struct ExrMaker {
  Imf::Header header{4, 3};
  std::vector<std::string> channels;
  Imf::PixelType type = Imf::FLOAT;

  void add(const std::string& name, const std::string& sensitivity = "") {
    channels.push_back(name);
    header.channels().insert(name, Imf::Channel(type));
    if (!sensitivity.empty()) header.insert(name, Imf::StringAttribute(sensitivity));
  }
  void write(const std::filesystem::path& file, bool tiled) {
    std::vector<float> values(channels.size() * 12);
    Imf::FrameBuffer frame;
    std::vector<uint16_t> halves(values.size());
    for (std::size_t c = 0; c < channels.size(); ++c) {
      for (std::size_t i = 0; i < 12; ++i) {
        values[c * 12 + i] = static_cast<float>(100 * c + 10 * (i / 4) + i % 4);
        halves[c * 12 + i] = half(values[c * 12 + i]).bits();
      }
      const bool is_half = type == Imf::HALF;
      const std::size_t size = is_half ? 2 : 4;
      char* base =
          is_half ? reinterpret_cast<char*>(&halves[c * 12]) : reinterpret_cast<char*>(&values[c * 12]);
      const auto& min = header.dataWindow().min;
      base -= static_cast<std::ptrdiff_t>(size) * (min.x + 4 * min.y);
      frame.insert(channels[c], Imf::Slice(type, base, size, size * 4));
    }
    if (tiled) {
      header.setTileDescription(Imf::TileDescription(3, 2, Imf::MIPMAP_LEVELS));
      Imf::TiledOutputFile out(file.c_str(), header);
      out.setFrameBuffer(frame);
      for (int level = 0; level < out.numLevels(); ++level)
        out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
    } else {
      Imf::OutputFile out(file.c_str(), header);
      out.setFrameBuffer(frame);
      out.writePixels(3);
    }
  }
};

TEST(ForeignExr, ScanLinesAndTilesOfAnyCompression) {
  const TemporaryFolder folder;
  for (const bool tiled : {false, true})
    for (const auto compression :
         {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION})
      for (const auto type : {Imf::FLOAT, Imf::HALF}) {
        ExrMaker maker;
        maker.type = type;
        maker.header.compression() = compression;
        maker.header.dataWindow() = Imath::Box2i(Imath::V2i(-5, 7), Imath::V2i(-2, 9));
        for (const char* name : {"S0.1000nm", "S0.400,5nm", "S0.0,7um", "R", "G", "B", "A"}) maker.add(name);
        maker.write(folder / "f.exr", tiled);
        const Cube cube = read_cube_file(folder / "f.exr", 2);
        ASSERT_EQ(cube.info.bands.size(), 3u);
        EXPECT_EQ(cube.info.aux, std::vector<std::string>{"A"});
        EXPECT_EQ(cube.info.quantity, Quantity::kDensity);
        // Wavelengths sort as numbers: 400.5, 700, 1000.
        EXPECT_DOUBLE_EQ(cube.info.bands[0].channel.min_nm, 400.5 - 149.75);
        EXPECT_DOUBLE_EQ(cube.info.bands[1].channel.max_nm, 850);
        EXPECT_DOUBLE_EQ(cube.info.bands[2].channel.max_nm, 1150);
        const std::size_t source[] = {1, 2, 0};
        for (std::size_t i = 0; i < 12; ++i) {
          for (std::size_t k = 0; k < 3; ++k)
            ASSERT_EQ(cube.mean[i * 3 + k], 100.0f * source[k] + 10.0f * (i / 4) + i % 4)
                << tiled << compression;
          EXPECT_EQ(cube.aux[i], 600.0f + 10.0f * (i / 4) + i % 4);
        }
      }
}

TEST(ForeignExr, SensitivitiesGiveBounds) {
  const TemporaryFolder folder;
  ExrMaker maker;
  maker.add("S0.550nm", "545nm:0;550nm:1;555nm:0;");
  maker.add("S0.600nm", "0.59um:1;0.62um:1");
  maker.add("S1.550nm");
  maker.add("T.550nm");
  maker.header.insert("emissiveUnits", Imf::StringAttribute("cd"));
  maker.write(folder / "f.exr", false);
  Messages messages;
  const auto cube = open_cube(folder / "f.exr", messages.sink());
  ASSERT_EQ(cube->info().bands.size(), 2u);
  EXPECT_EQ(cube->info().bands[0].channel.min_nm, 545);
  EXPECT_DOUBLE_EQ(cube->info().bands[1].channel.max_nm, 620);
  for (const char* part : {"sensitivities are not constant", "polarised", "reflective", "emissiveUnits 'cd'"})
    EXPECT_TRUE(messages.contain(part)) << part;
}

TEST(ForeignExr, ReflectiveChannelsAlone) {
  const TemporaryFolder folder;
  ExrMaker maker;
  maker.add("T.550nm");
  maker.write(folder / "f.exr", false);
  const auto cube = open_cube(folder / "f.exr");
  ASSERT_EQ(cube->info().bands.size(), 1u);
  EXPECT_EQ(cube->info().bands[0].channel.min_nm, 549.5);
}

TEST(ForeignExr, WhatIsNoCubeIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder / "f.exr";
  const auto error = [&](auto... names) {
    ExrMaker maker;
    (maker.add(names), ...);
    maker.write(file, false);
    return error_of<InputError>([&] { open_cube(file); });
  };
  EXPECT_EQ(error("R", "G", "B"),
            file.string() + ": no spectral channels: names such as S0.550,0nm or T.550,0nm are expected");
  EXPECT_EQ(error("S0.550nm", "S0.0,55um"),
            file.string() + ": channels 'S0.0,55um' and 'S0.550nm' have the same wavelength");
  ExrMaker maker;
  maker.add("S0.550nm", "wide");
  maker.write(file, false);
  EXPECT_EQ(
      error_of<InputError>([&] { open_cube(file); }),
      file.string() + ": sensitivity of channel 'S0.550nm': 'wide' is no spectrum such as 545nm:1;555nm:1;");
}

TEST(ForeignExr, AFileThatWasNeverFinishedIsIncomplete) {
  const TemporaryFolder folder;
  Imf::Header header(64, 64);
  header.channels().insert("S0.550nm", Imf::Channel(Imf::FLOAT));
  header.setTileDescription(Imf::TileDescription(32, 32, Imf::ONE_LEVEL));
  header.compression() = Imf::NO_COMPRESSION;
  std::vector<float> values(64 * 64);
  {
    Imf::TiledOutputFile out((folder / "f.exr").c_str(), header);
    Imf::FrameBuffer frame;
    frame.insert("S0.550nm", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 4 * 64));
    out.setFrameBuffer(frame);
    out.writeTiles(0, 1, 0, 0);
  }
  std::filesystem::resize_file(folder / "f.exr", 64 * 64 * 4 + 1000);
  EXPECT_EQ(
      error_of<InputError>([&] { open_cube(folder / "f.exr"); }),
      (folder / "f.exr").string() + ": the EXR file is incomplete: parts of the image were never written");
}

}  // namespace
}  // namespace kiloband
