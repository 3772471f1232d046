// Wrong command lines and damaged cubes of `convert`.
#include <gtest/gtest.h>

#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test::test_convert {
namespace {

/// cube.exr and short.hdr of 8 x 8 pixels in 4 channels from 400 to 700 nm.
void write_cubes(const TemporaryFolder& folder) {
  folder.write("scene.xml", complete_scene(""));
  const auto outcome = run_program(folder, quiet_render("scene.xml", {"--spp", "1", "--bands", "400:700:4",
                                                                      "-o", "cube.exr", "-o", "short.hdr"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
}

/// Variances do not scale, add or weigh as radiances do.
TEST(WrongConversion, Variances) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  ASSERT_EQ(run_program(folder, quiet_render("scene.xml", {"--spp", "8", "--variance", "-o", "v.hdr"})).code,
            0);
  const std::string expected =
      "v.var.hdr: holds variances, not radiances: give the cube itself, v.hdr, whose variances go with it";
  expect_refused(folder, {},
                 {
                     {{"convert", "v.var.hdr", "out.hdr", "--quantity", "density"}, expected},
                     {{"sensor", "v.var.hdr", "--png", "out.png"}, expected},
                 });
}

TEST(WrongConversion, Options) {
  const TemporaryFolder folder;
  write_cubes(folder);
  expect_refused(
      folder, {},
      {
          {{"convert", "cube.exr"}, "OUT is required (see kiloband convert --help)"},
          {{"convert", "none.exr", "out.hdr"}, "cannot open 'none.exr': No such file or directory"},
          {{"convert", "scene.xml", "out.hdr"},
           "'scene.xml': cannot tell the format of a cube: must end in .exr, .hdr or .img (ENVI)"},
          {{"convert", "cube.exr", "out.tif"},
           "'out.tif': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
      });
  expect_refused(
      folder, {"convert", "cube.exr", "out.hdr"},
      {
          {{"--select", "9"}, "band indices '9': the cube has 4 bands, counted from 0"},
          {{"--range", "red"}, "--range 'red': 'red': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
          {{"--rebin", "400:700:3"},
           "re-binning: channel 0 (400-500 nm) is not a union of whole channels: channel 1 (475-550 nm) "
           "reaches across 500 nm"},
          {{"--rebin", ""}, "--rebin '': no channels"},
          {{"--crop", "0,0,9,9"}, "region 0,0,9,9: must lie in the image of 8x8 pixels"},
          {{"--crop", "0,0,9"}, "--crop 0,0,9: must be 4 whole numbers separated by commas"},
          {{"--crop", "-1,0,1,1"}, "--crop -1,0,1,1: must be 4 whole numbers separated by commas"},
          {{"--crop", "4294967295,0,4294967295,1"},
           "region 4294967295,0,4294967295,1: must lie in the image of 8x8 pixels"},
          {{"--crop", ""}, "--crop : must be 4 whole numbers separated by commas"},
          {{"--quantity", "flux"},
           "--quantity: flux not in {integral,density} (see kiloband convert --help)"},
          {{"--pixel", "1,1"}, "--pixel, --region and --signature write CSV: the output must end in .csv"},
      });
  expect_refused(folder, {"convert", "cube.exr", "out.csv"},
                 {
                     {{}, "CSV output needs --pixel X,Y, --region X,Y,WIDTH,HEIGHT or --signature"},
                     {{"--pixel", "8,8"}, "region 8,8,1,1: must lie in the image of 8x8 pixels"},
                     {{"--pixel", "8"}, "--pixel 8: must be 2 whole numbers separated by commas"},
                     {{"--pixel", "1,"}, "--pixel 1,: must be 2 whole numbers separated by commas"},
                     {{"--region", "7,7,2,2"}, "region 7,7,2,2: must lie in the image of 8x8 pixels"},
                 });
}

/// One of each kind: tests/unit/cube has what else can be wrong.
TEST(WrongConversion, DamagedCubes) {
  const TemporaryFolder folder;
  write_cubes(folder);
  folder.write("spoiled.exr", "x" + folder.read("cube.exr").substr(1));
  folder.write("short.img", std::string(100, '\0'));
  folder.write("word.hdr", "word\n");
  expect_refused(
      folder, {"convert"},
      {
          {{"spoiled.exr", "out.exr"}, "spoiled.exr: not a readable EXR file: it does not begin as one"},
          {{"short.hdr", "out.exr"}, "short.img: the file has 100 bytes, its header needs 1024"},
          {{"word.hdr", "out.exr"}, "word.hdr:1: not an ENVI header: the first line must be 'ENVI'"},
      });
}

}  // namespace
}  // namespace kiloband::test::test_convert
