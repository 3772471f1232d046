// Selection, re-binning, cropping and tables of cubes.
#include "post/convert.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "tests/unit/cube/cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

class Convert : public testing::Test {
 protected:
  std::filesystem::path write(const Cube& cube, const char* name) {
    write_cube_file(cube, folder / name);
    return folder / name;
  }
  Cube converted(const std::filesystem::path& in, const char* name, const CubeSelection& selection = {}) {
    convert_cube(in, folder / name, selection, messages.sink());
    return read_cube(folder / name);
  }
  std::string selection_error(const std::filesystem::path& in, const CubeSelection& selection) {
    return error_of([&] { select_from_cube(open_cube(in), selection); });
  }
  /// A cube of small whole numbers, whose sums are exact.
  Cube whole_numbers(Quantity quantity = Quantity::kIntegral) {
    Cube cube = make_cube(6, 40, equal_bands(400, 480, 8), true, {"depth.Z"});
    cube.info.quantity = quantity;
    for (std::size_t i = 0; i < cube.mean.size(); ++i) cube.mean[i] = static_cast<float>(i % 1000);
    return cube;
  }
  TemporaryFolder folder;
  Messages messages;
  std::vector<std::string>& notes = messages.texts;
};

TEST_F(Convert, ThereAndBackKeepsEveryBit) {
  Cube cube = make_cube(35, 37, {{{700, 710, ""}, false}, {{400, 410, "x"}, false}, {{0, 0, "Y"}, true}},
                        true, {"depth.Z"});
  cube.info.metadata = {{"seed", "1"}};
  cube.info.replicates = 4;
  const auto in = write(cube, "a.hdr");
  CubeSelection keep;
  keep.quantity = Quantity::kIntegral;
  converted(in, "b.exr", keep);
  const Cube back = converted(folder / "b.exr", "c.hdr");
  EXPECT_EQ(count_differences(back.mean, cube.mean), 0u);
  EXPECT_EQ(count_differences(back.variance, cube.variance), 0u);
  EXPECT_EQ(count_differences(back.aux, cube.aux), 0u);
  EXPECT_EQ(back.info.metadata, cube.info.metadata);
  EXPECT_EQ(back.info.replicates, 4u);
  EXPECT_EQ(read_file(folder / "c.hdr"), read_file(folder / "a.hdr"));
}

TEST_F(Convert, InfiniteValuesAreWarnedOf) {
  Cube cube = make_cube(2, 1, equal_bands(400, 500, 2), true);
  cube.info.quantity = Quantity::kDensity;
  cube.mean = {50, 3e38f, 50, 50};  // 50 nm wide: the density of 3e38 is 6e36, its integral in the file fits
  cube.variance = {1, 1, 1, 1};
  const auto in = write(cube, "a.exr");
  converted(in, "b.exr");
  EXPECT_TRUE(notes.empty());
  cube.mean[1] = std::numeric_limits<float>::infinity();
  converted(write(cube, "c.exr"), "d.exr");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "1 values are infinite: too large for float32");
  notes.clear();
  // Densities of others that are too large as integrals.
  cube = make_cube(2, 1, equal_bands(400, 400.5, 2), true);
  cube.mean = {1, 3e38f, 1, 1};  // 0.25 nm wide
  cube.variance = {1, 1, 1e38f, 1};
  converted(write(cube, "e.hdr"), "f.exr");
  EXPECT_EQ(notes, (std::vector<std::string>{"1 values are infinite: too large for float32",
                                             "1 variances are infinite: too large for float32"}));
}

TEST_F(Convert, InfiniteValuesInTablesAreWarnedOf) {
  Cube cube = make_cube(2, 1, equal_bands(400, 500, 2), true);
  cube.mean = {50, std::numeric_limits<float>::infinity(), 50, 50};
  cube.variance = {1, std::numeric_limits<float>::infinity(), 1, 1};
  const auto reader = open_cube(write(cube, "a.hdr"));
  write_csv(*reader, folder / "t.csv", {{1, 0, 1, 1}}, messages.sink());
  EXPECT_TRUE(notes.empty());
  write_csv(*reader, folder / "t.csv", {{0, 0, 1, 1}, {0, 0, 2, 1}},
            messages.sink());  // a pixel with its error, a mean
  EXPECT_EQ(notes, std::vector<std::string>{"3 values or standard errors are infinite"});
}

/// An error of 0 is exact; of values whose errors have squares below floats it only looks so.
TEST_F(Convert, ErrorsBelowFloatsAreNotZero) {
  Cube cube = make_cube(1, 1, equal_bands(400, 500, 4), true);
  cube.mean = {5e-24f, 1, 0, 5e-24f};
  cube.variance = {0, 0, 0, 0x1p-120f};
  write_csv(*open_cube(write(cube, "a.hdr")), folder / "t.csv", {{0, 0, 1, 1}});
  const std::string text = read_file(folder / "t.csv");
  EXPECT_NE(text.find(",5e-24,nan\n"), std::string::npos) << text;
  EXPECT_NE(text.find(",1,0\n"), std::string::npos) << text;
  EXPECT_NE(text.find(",0,0\n"), std::string::npos) << text;
  EXPECT_NE(text.find(",5e-24,8.67"), std::string::npos) << text;
}

TEST_F(Convert, DensitiesAreCopiedWithoutRounding) {
  Cube cube = make_cube(5, 5, equal_bands(400, 500, 7));
  cube.info.quantity = Quantity::kDensity;
  const auto in = write(cube, "a.exr");
  const Cube copy = converted(in, "b.exr");
  EXPECT_EQ(copy.info.quantity, Quantity::kDensity);
  EXPECT_EQ(count_differences(copy.mean, read_cube(in).mean), 0u);
}

/// Reflectances of others, which state no quantity, were multiplied by widths that were guessed.
TEST_F(Convert, DensitiesAreMultipliedOnlyIfAsked) {
  const auto in = write(whole_numbers(), "a.hdr");
  const Cube density = converted(in, "b.exr");
  EXPECT_EQ(density.info.quantity, Quantity::kDensity);
  EXPECT_EQ(density.mean[17], 1.7f);
  const Cube kept = converted(folder / "b.exr", "c.hdr");
  EXPECT_EQ(kept.info.quantity, Quantity::kDensity);
  EXPECT_EQ(kept.mean[17], 1.7f);
  CubeSelection integral;
  integral.quantity = Quantity::kIntegral;
  EXPECT_EQ(converted(folder / "b.exr", "d.hdr", integral).mean[17], 17);
  EXPECT_EQ(converted(in, "e.hdr").mean[17], 17);
}

/// Centres of bands without widths moved to the middle between the neighbours.
TEST_F(Convert, UnevenCentresOfOthersStay) {
  const std::string size = "ENVI\nsamples = 1\nlines = 1\nbands = 5\ndata type = 4\ninterleave = bip\n";
  folder.write("s.hdr", size +
                            "byte order = 0\nwavelength units = Nanometers\n"
                            "wavelength = {442.7, 492.4, 559.8, 664.6, 1613.7}\n");
  const float values[] = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f};
  folder.write("s.img", std::string(reinterpret_cast<const char*>(values), sizeof values));
  const Cube cube = converted(folder / "s.hdr", "t.hdr");
  EXPECT_EQ(cube.mean, std::vector<float>(std::begin(values), std::end(values)));
  const std::string header = read_file(folder / "t.hdr");
  EXPECT_NE(header.find("wavelength = {442.7, 492.4, 559.8, 664.6, 1613.7}"), std::string::npos) << header;
  EXPECT_NE(header.find("band names = {442.7nm, 492.4nm, 559.8nm, 664.6nm, 1613.7nm}"), std::string::npos);
}

TEST_F(Convert, BandsAreChosenByIndexAndWavelength) {
  const Cube cube = whole_numbers();
  const auto in = write(cube, "a.hdr");
  CubeSelection selection;
  selection.bands = parse_band_indices("5-7,0", 8);
  const Cube some = converted(in, "b.hdr", selection);
  ASSERT_EQ(some.info.bands.size(), 4u);
  EXPECT_EQ(some.info.bands[3].channel.min_nm, 400);
  EXPECT_EQ(some.mean[0], cube.mean[5]);
  EXPECT_EQ(some.mean[4 + 3], cube.mean[8]);
  EXPECT_EQ(some.variance[1], cube.variance[6]);
  selection.range = WavelengthRange{455, 470};
  const Cube one = converted(in, "c.hdr", selection);
  ASSERT_EQ(one.info.bands.size(), 1u);
  EXPECT_EQ(one.info.bands[0].channel.min_nm, 460);
  selection.range = WavelengthRange{455, 465};
  EXPECT_EQ(selection_error(in, selection), "no band lies inside 455-465 nm");
  selection.bands = {8};
  EXPECT_EQ(selection_error(in, selection), "band index 8: the cube has 8 bands, counted from 0");
}

/// Edges that were computed differently are the same.
TEST_F(Convert, RangesTakeBandsOnTheirEdges) {
  const auto in = write(make_cube(1, 1, {{{512.3 - 5, 512.3 + 5, ""}, false}}), "a.hdr");
  CubeSelection selection;
  selection.range = WavelengthRange{507.3, 517.3};
  EXPECT_EQ(converted(in, "b.hdr", selection).info.bands.size(), 1u);
  folder.write("um.hdr",
               "ENVI\nsamples = 1\nlines = 1\nbands = 2\ndata type = 1\ninterleave = bsq\nbyte order = 0\n"
               "wavelength units = Micrometers\nwavelength = {1.005, 1.015}\nfwhm = {0.01, 0.01}\n");
  folder.write("um.img", "12");
  selection.range = WavelengthRange{1000, 1020};
  EXPECT_EQ(converted(folder / "um.hdr", "c.hdr", selection).info.bands.size(), 2u);
  selection.range = WavelengthRange{1000.001, 1020};
  EXPECT_EQ(converted(folder / "um.hdr", "d.hdr", selection).info.bands.size(), 1u);
}

TEST_F(Convert, IndexListsAreChecked) {
  EXPECT_EQ(parse_band_indices("3, 0-1", 4), (std::vector<std::size_t>{3, 0, 1}));
  const auto error = [](const char* text) { return error_of([&] { parse_band_indices(text, 4); }); };
  EXPECT_EQ(error("1-0"), "band indices '1-0': must be a list such as 0-9,20");
  EXPECT_EQ(error(""), "band indices '': must be a list such as 0-9,20");
  EXPECT_EQ(error("0-4"), "band indices '0-4': the cube has 4 bands, counted from 0");
  EXPECT_EQ(error("0-18446744073709551615"),
            "band indices '0-18446744073709551615': the cube has 4 bands, counted from 0");
  EXPECT_EQ(error("0-2,1"), "band indices '0-2,1': band 1 is given twice");
}

TEST_F(Convert, CoarseChannelsAreSumsOfIntegrals) {
  const Cube cube = whole_numbers();
  CubeSelection selection;
  selection.rebin = ChannelList{{400, 430, ""}, {470, 480, "last"}, {430, 470, ""}};
  selection.quantity = Quantity::kIntegral;
  for (const char* name : {"a.hdr", "a.exr"}) {  // integrals and densities
    Cube stored = cube;
    stored.info.quantity = std::string(name) == "a.exr" ? Quantity::kDensity : Quantity::kIntegral;
    const Cube coarse = converted(write(stored, name), "b.hdr", selection);
    ASSERT_EQ(coarse.info.bands.size(), 3u);
    EXPECT_EQ(coarse.info.bands[1].channel.name, "last");
    for (std::size_t p = 0; p < 240; ++p) {
      const float* fine = cube.mean.data() + p * 8;
      const float expected[] = {fine[0] + fine[1] + fine[2], fine[7], fine[3] + fine[4] + fine[5] + fine[6]};
      for (std::size_t m = 0; m < 3; ++m)
        EXPECT_NEAR(coarse.mean[p * 3 + m], expected[m], 1e-6f * expected[m]);
    }
    EXPECT_TRUE(coarse.info.variance);
    EXPECT_TRUE(std::isnan(coarse.variance[0]));
    EXPECT_NEAR(coarse.variance[1], cube.variance[7], 1e-6f * cube.variance[7]);
    EXPECT_NE(notes.back().find("2 of 3 channels are sums of channels and have no standard error"),
              std::string::npos);
  }
  selection.rebin = ChannelList{{400, 480, ""}};
  EXPECT_FALSE(converted(folder / "a.hdr", "c.hdr", selection).info.variance);
}

TEST_F(Convert, EdgesThatWereComputedDifferentlyStillFit) {
  Cube cube = make_cube(1, 1, equal_bands(380, 780, 300));
  std::fill(cube.mean.begin(), cube.mean.end(), 1.0f);
  const auto in = write(cube, "a.hdr");
  CubeSelection selection;
  selection.rebin = ChannelList();
  for (const Band& band : equal_bands(380, 780, 30)) selection.rebin->push_back(band.channel);
  for (const float v : converted(in, "b.hdr", selection).mean) EXPECT_EQ(v, 10);
}

TEST_F(Convert, CoarseChannelsMustBeUnions) {
  Cube cube = make_cube(1, 1,
                        {{{400, 410, ""}, false},
                         {{410, 420, ""}, false},
                         {{425, 430, ""}, false},
                         {{405, 425, ""}, false},
                         {{0, 0, "Y"}, true}});
  const auto in = write(cube, "a.hdr");
  const auto error = [&](double low, double high) {
    CubeSelection selection;
    selection.rebin = ChannelList{{400, 410, ""}, {low, high, ""}};
    return selection_error(in, selection);
  };
  EXPECT_EQ(
      error(402, 420),
      "re-binning: channel 1 (402-420 nm) is not a union of whole channels: channel 0 (400-410 nm) reaches "
      "across 402 nm");
  EXPECT_EQ(
      error(400, 415),
      "re-binning: channel 1 (400-415 nm) is not a union of whole channels: channel 1 (410-420 nm) reaches "
      "across 415 nm");
  EXPECT_EQ(error(400, 430),
            "re-binning: channel 1 (400-430 nm) is not a union of whole channels: the channels leave gaps or "
            "overlap "
            "there");
  EXPECT_EQ(error(405, 430), "accepted");  // 405-425 and 425-430
}

TEST_F(Convert, CropsAreRegionsOfTheImage) {
  const Cube cube = whole_numbers();
  const auto in = write(cube, "a.exr");
  CubeSelection selection;
  selection.crop = PixelRect{2, 31, 3, 5};
  const Cube part = converted(in, "b.exr", selection);
  EXPECT_EQ(part.info.width, 3u);
  EXPECT_EQ(part.info.height, 5u);
  const Cube whole = read_cube(converted(in, "c.exr").info.width ? folder / "c.exr" : in);
  for (std::size_t y = 0; y < 5; ++y)
    for (std::size_t x = 0; x < 3; ++x) {
      EXPECT_EQ(part.mean[(y * 3 + x) * 8 + 1], whole.mean[((y + 31) * 6 + x + 2) * 8 + 1]);
      EXPECT_EQ(part.aux[y * 3 + x], cube.aux[(y + 31) * 6 + x + 2]);
    }
  selection.crop = PixelRect{4, 0, 3, 1};
  EXPECT_EQ(selection_error(in, selection), "region 4,0,3,1: must lie in the image of 6x40 pixels");
  selection.crop = PixelRect{0, 0, 0, 1};
  EXPECT_EQ(selection_error(in, selection), "region 0,0,0,1: must lie in the image of 6x40 pixels");
}

/// The reference pixel moves with the image's corner, which keeps its place in the image that it is cut out of.
TEST_F(Convert, CropsKeepTheirPlaceOnTheGround) {
  Cube cube = whole_numbers();
  cube.info.metadata = {{"Map Info", "{UTM, 1.000, 1.5, 500000.0, 4100000.0, 10.0, 10.0, 33, North, WGS-84}"},
                        {"x start", "1"},
                        {"y start", "101"}};
  CubeSelection selection;
  selection.crop = PixelRect{2, 31, 3, 5};
  const Cube part = converted(write(cube, "a.hdr"), "b.hdr", selection);
  EXPECT_EQ(part.info.metadata.at("Map Info"),
            "{UTM, -1, -29.5, 500000.0, 4100000.0, 10.0, 10.0, 33, North, WGS-84}");
  EXPECT_EQ(part.info.metadata.at("x start"), "3");
  EXPECT_EQ(part.info.metadata.at("y start"), "132");
  EXPECT_TRUE(notes.empty());
  cube.info.metadata.erase("x start");  // 1 where it is not stated
  const Cube other = converted(write(cube, "a.hdr"), "b.hdr", selection);
  EXPECT_EQ(other.info.metadata.at("x start"), "3");
  EXPECT_EQ(other.info.metadata.at("y start"), "132");
}

TEST_F(Convert, CropsLoseWhatTheyCannotMove) {
  Cube cube = whole_numbers();
  const std::map<std::string, std::string> metadata = {{"map info", "{UTM, one, 1, 5, 6}"},
                                                       {"x start", "left"},
                                                       {"y start", "3"},
                                                       {"geo points", "{1, 1, 50, 10, 6, 1, 50, 11}"},
                                                       {"RPC Info", "{1, 2, 3}"},
                                                       {"seed", "1"}};
  cube.info.metadata = metadata;
  const auto in = write(cube, "a.exr");
  CubeSelection selection;
  selection.crop = PixelRect{0, 0, 6, 20};  // the corner stays
  EXPECT_EQ(converted(in, "b.exr", selection).info.metadata, metadata);
  EXPECT_TRUE(notes.empty());
  selection.crop = PixelRect{1, 0, 5, 40};
  EXPECT_EQ(converted(in, "b.exr", selection).info.metadata,
            (std::map<std::string, std::string>{{"seed", "1"}}));
  std::ranges::sort(notes);
  const std::string dropped = "left out: it is of the image before it was cropped";
  EXPECT_EQ(notes, (std::vector<std::string>{
                       "RPC Info: " + dropped, "geo points: " + dropped,
                       "map info '{UTM, one, 1, 5, 6}': not understood, so it is " + dropped,
                       "x start 'left': not understood, so it is " + dropped, "y start: " + dropped}));
}

TEST_F(Convert, PixelsAndRegionsAsTables) {
  Cube cube = make_cube(2, 2, {{{400, 410, ""}, false}, {{0, 0, "a,\"b\""}, true}}, true);
  cube.mean = {1, 10, 2, 20, 3, 30, NAN, 0.1f};
  cube.variance = {4, 9, 1, 1, 1, 1, NAN, 2.25f};
  const auto reader = open_cube(write(cube, "a.hdr"));
  const auto table = [&](const std::vector<PixelRect>& places) {
    write_csv(*reader, folder / "t.csv", places);
    return read_file(folder / "t.csv");
  };
  EXPECT_EQ(table({{0, 0, 1, 1}}),
            "channel,min_nm,max_nm,value,standard_error\n405nm,400,410,1,2\n\"a,\"\"b\"\"\",,,10,3\n");
  EXPECT_EQ(table({{1, 1, 1, 1}}),
            "channel,min_nm,max_nm,value,standard_error\n405nm,400,410,nan,nan\n\"a,\"\"b\"\"\",,,0.1,1.5\n");
  // (1 + 2 + 3) / 3: the pixel without a number does not count, and there is no error.
  EXPECT_EQ(table({{0, 0, 2, 2}}).substr(0, 52),
            "channel,min_nm,max_nm,value\n405nm,400,410,2\n\"a,\"\"b\"\"");
  EXPECT_EQ(table({{0, 1, 1, 1}, {0, 0, 2, 1}}),
            "x,y,width,height,channel,min_nm,max_nm,value,standard_error\n"
            "0,1,1,1,405nm,400,410,3,1\n0,1,1,1,\"a,\"\"b\"\"\",,,30,1\n"
            "0,0,2,1,405nm,400,410,1.5,\n0,0,2,1,\"a,\"\"b\"\"\",,,15,\n");
  EXPECT_EQ(error_of([&] { table({}); }), "CSV: no pixel or region is given");
  EXPECT_EQ(error_of([&] { table({{2, 0, 1, 1}}); }), "region 2,0,1,1: must lie in the image of 2x2 pixels");
}

TEST_F(Convert, TablesFollowSelectionAndQuantity) {
  const Cube cube = whole_numbers();
  CubeSelection selection;
  selection.rebin = ChannelList{{400, 420, ""}};
  selection.quantity = Quantity::kDensity;
  const auto part = select_from_cube(open_cube(write(cube, "a.hdr")), selection);
  write_csv(*part, folder / "t.csv", {{3, 0, 1, 1}});
  EXPECT_EQ(read_file(folder / "t.csv"),
            "channel,min_nm,max_nm,value\n410nm,400,420,2.45\n");  // (24 + 25) / 20
}

}  // namespace
}  // namespace kiloband
