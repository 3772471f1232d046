// What stands in our EXR files, looked at through OpenEXR alone.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledInputFile.h>
#include <gtest/gtest.h>

#include "cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

std::string text(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute ? attribute->value() : "(missing)";
}

std::vector<std::string> channel_names(const Imf::Header& header) {
  std::vector<std::string> names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) names.push_back(c.name());
  return names;
}

class ExrFile : public testing::Test {
 protected:
  TemporaryFolder folder;
};

TEST_F(ExrFile, HasTheLayoutsChannelsAndAttributes) {
  Cube cube = make_cube(40, 33,
                        {{{545, 555, ""}, false},
                         {{8000, 8000.5, ""}, false},
                         {{540, 560, "wide"}, false},
                         {{400, 700, "Y"}, true}},
                        true, {"depth.Z"});
  cube.info.quantity = Quantity::kDensity;
  cube.info.samples_per_pixel = 64;
  cube.info.replicates = 16;
  cube.info.metadata = {{"seed", "3"}, {"compression", "none of EXR's business"}};
  write_cube_file(cube, folder / "a.exr");
  const Imf::TiledInputFile file((folder / "a.exr").c_str());
  const Imf::Header& header = file.header();
  EXPECT_EQ(channel_names(header),
            (std::vector<std::string>{"B", "G", "R", "S0.550,000000nm", "S0.550,000000nm_2",
                                      "S0.8000,250000nm", "depth.Z", "response.Y", "var.S0.550,000000nm",
                                      "var.S0.550,000000nm_2", "var.S0.8000,250000nm", "var.response.Y"}));
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    EXPECT_EQ(c.channel().type, Imf::FLOAT) << c.name();
  EXPECT_EQ(header.lineOrder(), Imf::RANDOM_Y);
  EXPECT_EQ(header.compression(), Imf::NO_COMPRESSION);
  EXPECT_EQ(file.tileXSize(), 32u);
  EXPECT_EQ(file.tileYSize(), 32u);
  EXPECT_TRUE(file.isComplete());
  EXPECT_EQ(text(header, "S0.550,000000nm"), "545nm:1;555nm:1;");
  EXPECT_EQ(text(header, "S0.550,000000nm_2"), "540nm:1;560nm:1;");
  EXPECT_EQ(text(header, "S0.8000,250000nm"), "8000nm:1;8000.5nm:1;");
  EXPECT_EQ(text(header, "response.Y"), "(missing)");
  EXPECT_EQ(text(header, "spectralLayoutVersion"), "1.0");
  EXPECT_EQ(text(header, "emissiveUnits"), "W.m^-2.sr^-1");
  EXPECT_EQ(header.typedAttribute<Imf::FloatAttribute>("EV").value(), 0);
  EXPECT_EQ(text(header, "bandQuantity"), "mean spectral radiance of the band, W.m^-2.sr^-1.nm^-1");
  EXPECT_EQ(text(header, "kilobandBands"),
            "S0.550,000000nm 545 555;S0.8000,250000nm 8000 8000.5;S0.550,000000nm_2 540 560 wide;"
            "response.Y 400 700 Y;");
  EXPECT_EQ(text(header, "kilobandAux"), "depth.Z;");
  EXPECT_EQ(text(header, "kilobandSamplesPerPixel"), "64");
  EXPECT_EQ(text(header, "kilobandReplicates"), "16");
  EXPECT_EQ(text(header, "seed"), "3");
  EXPECT_EQ(text(header, "meta.compression"), "none of EXR's business");
}

TEST_F(ExrFile, IntegralsSaySo) {
  write_cube_file(make_cube(2, 2, equal_bands(400, 500, 1)), folder / "a.exr");
  const Imf::TiledInputFile file((folder / "a.exr").c_str());
  EXPECT_EQ(text(file.header(), "bandQuantity"), "band radiance (integral over the band), W.m^-2.sr^-1");
}

TEST_F(ExrFile, ThePreviewIsTheWeightedSumOfIntegrals) {
  Cube cube = make_cube(32, 32, equal_bands(380, 780, 9));
  cube.info.quantity = Quantity::kDensity;
  for (float& v : cube.mean) v = 1 + static_cast<float>(&v - cube.mean.data()) * 1e-4f;
  write_cube_file(cube, folder / "a.exr");
  Imf::TiledInputFile file((folder / "a.exr").c_str());
  std::vector<float> red(32 * 32);
  Imf::FrameBuffer frame;
  frame.insert("R", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(red.data()), 4, 4 * 32));
  file.setFrameBuffer(frame);
  file.readTile(0, 0);
  const auto weights = preview_weights(cube.info.bands);
  for (const std::size_t pixel : {0, 517, 1023}) {
    double expected = 0;
    for (std::size_t k = 0; k < 9; ++k) expected += double{weights[k][0]} * cube.mean[pixel * 9 + k];
    EXPECT_NEAR(red[pixel], expected, 1e-5 * std::abs(expected));
  }
}

TEST_F(ExrFile, ManyChannelsGetSmallerTiles) {
  // 20,000 channels and three of the preview: 32x32 pixels would be 82 MB, 16x16 are 20 MB.
  const Cube cube = make_cube(18, 17, equal_bands(380, 20000, 20'000));
  write_cube_file(cube, folder / "a.exr");
  EXPECT_EQ(Imf::TiledInputFile((folder / "a.exr").c_str()).tileXSize(), 16u);
  EXPECT_EQ(count_differences(read_cube(folder / "a.exr", 17).mean, cube.mean), 0u);
}

TEST_F(ExrFile, ChannelsThatOthersChangedAreFoundByName) {
  // A copy without our list (as another program may make it) is read by wavelength, with exact bounds.
  Cube cube = make_cube(3, 3, {{{600, 610, ""}, false}, {{400, 430, ""}, false}});
  write_cube_file(cube, folder / "a.exr");
  std::string bytes = read_file(folder / "a.exr");
  bytes.replace(bytes.find("kilobandBands"), 4, "lost");
  folder.write("b.exr", bytes);
  const Cube read = read_cube(folder / "b.exr");
  ASSERT_EQ(read.info.bands.size(), 2u);
  EXPECT_EQ(read.info.bands[0].channel.min_nm, 400);
  EXPECT_EQ(read.info.bands[0].channel.max_nm, 430);
  EXPECT_EQ(read.mean[0], cube.mean[1]);
}

/// As with ENVI: 4294967298 would be read as 2.
TEST_F(ExrFile, CountsAreWholeNumbersThatFit) {
  Cube cube = make_cube(2, 2, equal_bands(400, 500, 1), true);
  cube.info.replicates = 1'000'000'000;
  write_cube_file(cube, folder / "a.exr");
  const std::string good = folder.read("a.exr");
  for (const char* count : {"9999999999", "99999999 9"}) {
    std::string bytes = good;
    folder.write("b.exr", bytes.replace(bytes.find("1000000000"), 10, count));
    EXPECT_EQ(
        error_of(folder, [&] { open_cube(folder / "b.exr"); }),
        "b.exr: kilobandReplicates '" + std::string(count) + "': must be a whole number, at most 4294967295");
  }
  EXPECT_EQ(open_cube(folder / "a.exr")->info().replicates, 1'000'000'000u);
}

TEST_F(ExrFile, NamesThatCollideAreRefused) {
  for (const char* name : {"R", "S0.450,000000nm", "var.S0.450,000000nm", "S0.123nm"}) {
    const Cube cube = make_cube(2, 2, equal_bands(400, 500, 1), true, {name});
    EXPECT_EQ(error_of([&] { create_cube_writer(folder / "a.exr", cube.info, 2); }),
              (folder / "a.exr").string() + ": auxiliary plane '" + name +
                  "': the name is that of another EXR channel");
  }
  // Readers take variances where every band has one.
  const std::string name = "var.S0.450,000000nm";
  const Cube one = make_cube(2, 2, equal_bands(400, 500, 1), false, {name});
  EXPECT_EQ(error_of([&] { create_cube_writer(folder / "a.exr", one.info, 2); }),
            (folder / "a.exr").string() + ": auxiliary plane '" + name +
                "': would be read as the variance of a band");
  EXPECT_TRUE(folder.list().empty());
  const Cube two = make_cube(2, 2, {{{400, 500, ""}, false}, {{500, 600, ""}, false}}, false, {name});
  write_cube_file(two, folder / "b.exr");
  EXPECT_EQ(read_cube(folder / "b.exr").info.aux, std::vector{name});
}

}  // namespace
}  // namespace kiloband
