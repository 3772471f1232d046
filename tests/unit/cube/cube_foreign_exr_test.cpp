// EXR cubes of other programs.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include "cube_support.hpp"
#include "post/convert.hpp"
#include "post/sensor_cube.hpp"

namespace kiloband {
namespace {

using namespace test;

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
        const Cube cube = read_cube(folder / "f.exr", 2);
        ASSERT_EQ(cube.info.bands.size(), 3u);
        const Cube by_row = read_cube(folder / "f.exr", 1);
        EXPECT_EQ(by_row.mean, cube.mean);
        EXPECT_EQ(by_row.aux, cube.aux);
        EXPECT_EQ(cube.info.aux, std::vector<std::string>{"A"});
        EXPECT_EQ(cube.info.quantity, Quantity::kDensity);
        // Wavelengths sort as numbers: 400.5, 700, 1000.
        EXPECT_DOUBLE_EQ(cube.info.bands[0].channel.min_nm, 400.5 - 149.75);
        EXPECT_DOUBLE_EQ(cube.info.bands[1].channel.max_nm, 849.75);
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
    return error_of([&] { open_cube(file); });
  };
  EXPECT_EQ(error("R", "G", "B"),
            file.string() + ": no spectral channels: names such as S0.550,0nm or T.550,0nm are expected");
  EXPECT_EQ(error("S0.550nm", "S0.0,55um"),
            file.string() + ": channels 'S0.0,55um' and 'S0.550nm' have the same wavelength");
  ExrMaker maker;
  maker.add("S0.550nm", "wide");
  maker.write(file, false);
  EXPECT_EQ(
      error_of([&] { open_cube(file); }),
      file.string() + ": sensitivity of channel 'S0.550nm': 'wide' is no spectrum such as 545nm:1;555nm:1;");
}

/// As Mitsuba 3.9.1 writes a specfilm's file: the names of the film's spectra, HALF, PIZ, one attribute.
ExrMaker mitsuba_file(const std::vector<std::string>& names) {
  ExrMaker maker;
  maker.type = Imf::HALF;
  maker.header.compression() = Imf::PIZ_COMPRESSION;
  maker.header.insert("generatedBy", Imf::StringAttribute("Mitsuba version 3.9.1"));
  for (const std::string& name : names) maker.add(name);
  return maker;
}

TEST(MitsubaExr, BandsOfASpecfilmHaveNamesOnly) {
  const TemporaryFolder folder;
  mitsuba_file({"red", "green", "img.R", "m2_img.X", "dd.T", "A"}).write(folder / "f.exr", false);
  Messages messages;
  const auto reader = open_cube(folder / "f.exr", messages.sink());
  const Cube cube = read_cube(*reader);
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "written by Mitsuba, which states no wavelengths: the bands have names only (kiloband convert "
            "--wavelengths gives them some); values are integrals of radiance times response, W.m^-2.sr^-1");
  EXPECT_EQ(cube.info.quantity, Quantity::kIntegral);
  ASSERT_EQ(cube.info.bands.size(), 3u);  // in the order of an EXR file: of the names
  const char* names[] = {"A", "green", "red"};
  const float first[] = {500, 100, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(cube.info.bands[k].derived);
    EXPECT_EQ(cube.info.bands[k].channel.name, names[k]);
    EXPECT_EQ(cube.info.bands[k].channel.width_nm(), 0);
    EXPECT_EQ(cube.mean[3 * 6 + k], first[k] + 12);  // pixel (2, 1)
  }
  EXPECT_EQ(cube.info.aux, (std::vector<std::string>{"dd.T", "img.R", "m2_img.X"}));
  EXPECT_FALSE(cube.info.variance);
}

TEST(MitsubaExr, APictureIsNoCube) {
  const TemporaryFolder folder;
  const auto file = folder / "f.exr";
  const std::string refusal =
      file.string() + ": no spectral channels: names such as S0.550,0nm or T.550,0nm are expected";
  mitsuba_file({"R", "G", "B", "A", "dd.T"}).write(file, false);
  EXPECT_EQ(error_of([&] { open_cube(file); }), refusal);
  ExrMaker other;  // names of unknown origin say nothing
  other.add("red");
  other.write(file, false);
  EXPECT_EQ(error_of([&] { open_cube(file); }), refusal);
  mitsuba_file({"R", "G", "B", "infrared"}).write(file, false);
  EXPECT_EQ(open_cube(file)->info().bands.size(), 4u);
}

TEST(MitsubaExr, SpectralNamesAreThoseOfTheSpectralLayout) {
  const TemporaryFolder folder;
  mitsuba_file({"S0.550nm", "S0.560nm", "red"}).write(folder / "f.exr", false);
  const auto cube = open_cube(folder / "f.exr");
  ASSERT_EQ(cube->info().bands.size(), 2u);
  EXPECT_EQ(cube->info().bands[1].channel.min_nm, 555);
  EXPECT_EQ(cube->info().quantity, Quantity::kDensity);
}

TEST(MitsubaExr, WavelengthsCanBeGiven) {
  const TemporaryFolder folder;
  mitsuba_file({"red", "green", "all"}).write(folder / "f.exr", false);
  CubeSelection selection;
  selection.wavelengths = parse_band_wavelengths("red=600-700,  green = 500-600");
  convert_cube(folder / "f.exr", folder / "g.exr", selection);
  const Cube cube = read_cube(folder / "g.exr");
  ASSERT_EQ(cube.info.bands.size(), 3u);
  EXPECT_EQ(cube.info.bands[0].channel.name, "red");
  EXPECT_EQ(cube.info.bands[0].channel.min_nm, 600);
  EXPECT_EQ(cube.info.bands[1].channel.max_nm, 600);
  EXPECT_FALSE(cube.info.bands[1].derived);
  EXPECT_TRUE(cube.info.bands[2].derived);
  // EXR holds densities: integrals of 0, 100 and 200 + 12 at pixel (2, 1), the first two over 100 nm.
  EXPECT_FLOAT_EQ(cube.mean[6 * 3], 0.12f);
  EXPECT_FLOAT_EQ(cube.mean[6 * 3 + 1], 1.12f);
  EXPECT_EQ(cube.mean[6 * 3 + 2], 212);
}

TEST(MitsubaExr, WrongWavelengths) {
  const auto parse = [](const char* text) { return error_of([&] { parse_band_wavelengths(text); }); };
  EXPECT_EQ(parse("# nothing\n"), "wavelengths: none are given (NAME=MIN-MAX in nm, such as red=600-700)");
  EXPECT_EQ(parse("600-700"), "wavelengths '600-700': must be NAME=MIN-MAX in nm, such as red=600-700");
  EXPECT_EQ(parse("a=400:500:2"), "wavelengths 'a=400:500:2': must be one interval such as 600-700");
  EXPECT_EQ(parse("a=400-500\na=500-600"), "wavelengths of band 'a': given twice");
  const TemporaryFolder folder;
  mitsuba_file({"red", "green"}).write(folder / "f.exr", false);
  mitsuba_file({"S0.550nm"}).write(folder / "s.exr", false);
  const auto give = [&](const char* file, const char* text) {
    CubeSelection selection;
    selection.wavelengths = parse_band_wavelengths(text);
    return error_of([&] { select_from_cube(open_cube(folder / file), selection); });
  };
  EXPECT_EQ(give("f.exr", "blue=400-500"),
            "wavelengths of band 'blue': the cube has no such band; without wavelengths are 'green', 'red'");
  EXPECT_EQ(give("s.exr", "blue=400-500"),
            "wavelengths of band 'blue': the cube has no such band; all of its bands have wavelengths");
  EXPECT_EQ(
      error_of([&] { apply_responses(open_cube(folder / "f.exr"), xyz_responses()); }),
      "response 'X': no band of the cube has wavelengths: give them with kiloband convert --wavelengths");
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
      error_of([&] { open_cube(folder / "f.exr"); }),
      (folder / "f.exr").string() + ": the EXR file is incomplete: parts of the image were never written");
}

}  // namespace
}  // namespace kiloband
