// What stands in our ENVI files.
#include <gtest/gtest.h>

#include <cstring>

#include "cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

TEST(EnviFile, HeaderIsExact) {
  Cube cube = make_cube(3, 2, {{{545, 555, ""}, false}, {{540.5, 560, ""}, false}, {{400, 700, "Y,1"}, true}},
                        true, {"depth.Z"});
  cube.info.samples_per_pixel = 64;
  cube.info.replicates = 16;
  cube.info.metadata = {{"seed", "3"}, {"bands", "many"}};
  const TemporaryFolder folder;
  write_cube_file(cube, folder / "a.hdr");
  EXPECT_EQ(read_file(folder / "a.hdr"),
            "ENVI\n"
            "description = {band radiance (integral over the band) in W m^-2 sr^-1; derived bands in units "
            "of their "
            "responses; written by kiloband}\n"
            "samples = 3\n"
            "lines = 2\n"
            "bands = 3\n"
            "header offset = 0\n"
            "file type = ENVI Standard\n"
            "data type = 4\n"
            "interleave = bsq\n"
            "byte order = 0\n"
            "wavelength units = Nanometers\n"
            "wavelength = {550, 550.25, 550}\n"
            "fwhm = {10, 19.5, 300}\n"
            "band names = {550nm, 550.25nm, Y%2C1}\n"
            "default bands = {2, 2, 1}\n"
            "kiloband band minimum = {545, 540.5, 400}\n"
            "kiloband band maximum = {555, 560, 700}\n"
            "kiloband derived bands = {0, 0, 1}\n"
            "kiloband own names = {, , Y%2C1}\n"
            "kiloband layout = 1\n"
            "kiloband quantity = integral\n"
            "kiloband samples per pixel = 64\n"
            "kiloband replicates = 16\n"
            "kiloband variance = 1\n"
            "kiloband aux = 1\n"
            "meta.bands = many\n"
            "seed = 3\n");
  const std::string variance = read_file(folder / "a.var.hdr"), aux = read_file(folder / "a.aux.hdr");
  EXPECT_NE(variance.find("description = {variance of the mean (NaN: none) of band radiance"),
            std::string::npos);
  EXPECT_NE(variance.find("data ignore value = nan\n"), std::string::npos);
  EXPECT_NE(aux.find("bands = 1\n"), std::string::npos);
  EXPECT_NE(aux.find("band names = {depth.Z}\n"), std::string::npos);
  EXPECT_EQ(aux.find("wavelength"), std::string::npos);
}

TEST(EnviFile, DataAreBandSequentialLittleEndianFloats) {
  const Cube cube = make_cube(5, 70, equal_bands(400, 500, 20));
  const TemporaryFolder folder;
  write_cube_file(cube, folder / "a.hdr");
  const std::string bytes = read_file(folder / "a.img");
  ASSERT_EQ(bytes.size(), cube.mean.size() * 4);
  for (std::size_t k = 0; k < 20; ++k)
    for (std::size_t p = 0; p < 350; ++p) {
      uint32_t bits = 0;
      for (std::size_t b = 4; b-- > 0;) bits = bits << 8 | static_cast<uint8_t>(bytes[(k * 350 + p) * 4 + b]);
      ASSERT_EQ(bits, std::bit_cast<uint32_t>(cube.mean[p * 20 + k]));
    }
}

TEST(EnviFile, TheImageOpensLikeItsHeader) {
  const Cube cube = make_cube(2, 2, equal_bands(400, 500, 2));
  const TemporaryFolder folder;
  write_cube_file(cube, folder / "dir.name.hdr");
  EXPECT_EQ(folder.list(), (std::vector<std::string>{"dir.name.hdr", "dir.name.img"}));
  EXPECT_EQ(count_differences(read_cube(folder / "dir.name.img").mean, cube.mean), 0u);
}

TEST(EnviFile, VarianceAndAuxiliaryFilesOpenAlone) {
  const Cube cube = make_cube(2, 2, equal_bands(400, 500, 2), true, {"depth.Z", "a,b"});
  const TemporaryFolder folder;
  write_cube_file(cube, folder / "a.hdr");
  const Cube variance = read_cube(folder / "a.var.hdr"), aux = read_cube(folder / "a.aux.img");
  EXPECT_EQ(count_differences(variance.mean, cube.variance), 0u);
  EXPECT_EQ(count_differences(aux.mean, cube.aux), 0u);
  EXPECT_TRUE(aux.info.bands[1].derived);
  EXPECT_EQ(aux.info.bands[1].channel.name, "a,b");
}

TEST(EnviFile, AVarianceFileOfAnotherCubeIsRefused) {
  const TemporaryFolder folder;
  write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2), true), folder / "a.hdr");
  write_cube_file(make_cube(3, 2, equal_bands(400, 500, 2), true), folder / "b.hdr");
  std::filesystem::copy_file(folder / "b.var.hdr", folder / "a.var.hdr",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(error_of([&] { open_cube(folder / "a.hdr"); }),
            (folder / "a.var.hdr").string() + ": 3x2x2 values do not fit the cube's 2x2x2");
}

TEST(EnviFile, APartOfANewerLayoutIsRefused) {
  const TemporaryFolder folder;
  write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2), true), folder / "a.hdr");
  std::string header = folder.read("a.var.hdr");
  header.replace(header.find("kiloband layout = 1"), 19, "kiloband layout = 2");
  folder.write("a.var.hdr", header);
  EXPECT_NE(error_of([&] { open_cube(folder / "a.hdr"); }).find("a.var.hdr:"), std::string::npos);
}

/// Their names end like those of parts, and that is all.
TEST(EnviFile, CubesNamedLikePartsStay) {
  const TemporaryFolder folder;
  const Cube other = make_cube(2, 2, equal_bands(400, 500, 2));
  for (const char* name : {"a.var.hdr", "a.aux.hdr"}) write_cube_file(other, folder / name);
  write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2)), folder / "a.hdr");
  EXPECT_EQ(folder.list(),
            (std::vector<std::string>{"a.aux.hdr", "a.aux.img", "a.hdr", "a.img", "a.var.hdr", "a.var.img"}));
  EXPECT_FALSE(open_cube(folder / "a.hdr")->info().variance);
  EXPECT_EQ(count_differences(read_cube(folder / "a.var.hdr").mean, other.mean), 0u);
}

TEST(EnviFile, CubesNamedLikePartsAreNotReplaced) {
  const TemporaryFolder folder;
  const auto error = [&](bool variance, const std::vector<std::string>& aux) {
    return error_of(folder, [&] {
      write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2), variance, aux), folder / "a.hdr");
    });
  };
  write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2)), folder / "a.var.hdr");
  folder.write("a.aux.hdr", "ENVI\nsamples = 1\n");
  EXPECT_EQ(error(true, {}),
            "'a.var.hdr': is a cube of its own, which the variances of a.hdr would replace: give one of them "
            "another name");
  EXPECT_EQ(
      error(false, {"depth.Z"}),
      "'a.aux.hdr': is a cube of its own, which the auxiliary planes of a.hdr would replace: give one of "
      "them another name");
  EXPECT_EQ(folder.list(), (std::vector<std::string>{"a.aux.hdr", "a.var.hdr", "a.var.img"}));
  folder.write("a.var.hdr", "no header");
  folder.write("a.aux.hdr", "");
  EXPECT_EQ(error(true, {"depth.Z"}), "accepted");
  EXPECT_EQ(error(true, {"depth.Z"}), "accepted");
}

/// Those of the first versions did not say what they are.
TEST(EnviFile, PartsOfAnEarlierCubeGo) {
  for (const bool first_version : {false, true}) {
    const TemporaryFolder folder;
    write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2), true, {"depth.Z"}), folder / "a.hdr");
    if (first_version) {
      std::string header = folder.read("a.var.hdr");
      const std::string content = "kiloband content = variance\n";
      folder.write("a.var.hdr", header.erase(header.find(content), content.size()));
      EXPECT_TRUE(open_cube(folder / "a.hdr")->info().variance);
    }
    write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2)), folder / "a.hdr");
    EXPECT_EQ(folder.list(), (std::vector<std::string>{"a.hdr", "a.img"}));
  }
}

TEST(EnviFile, ACubeInThePlaceOfAPartIsRefused) {
  const TemporaryFolder folder;
  const Cube other = make_cube(2, 2, equal_bands(400, 500, 2));
  const auto error = [&] { return error_of(folder, [&] { open_cube(folder / "a.hdr"); }); };
  write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2), true, {"depth.Z"}), folder / "a.hdr");
  write_cube_file(other, folder / "a.aux.hdr");
  EXPECT_EQ(
      error(),
      "a.aux.hdr: must hold the auxiliary planes of a.hdr but is a cube of its own: put the planes back, or "
      "take 'kiloband aux' out of a.hdr");
  write_cube_file(other, folder / "a.var.hdr");
  EXPECT_EQ(
      error(),
      "a.var.hdr: must hold the variances of a.hdr but is a cube of its own: put the variances back, or "
      "take 'kiloband variance' out of a.hdr");
}

}  // namespace
}  // namespace kiloband
