// Wrong command lines and damaged cubes of `convert`.
#include <gtest/gtest.h>

#include "tests/end_to_end/support/wrong_input.hpp"

namespace kiloband::test {
namespace {

std::vector<std::string> convert(const std::string& out, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"convert", "cube.exr", out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}
std::vector<std::string> to_cube(const std::vector<std::string>& more) {
  return convert("out.hdr", more);
}
std::vector<std::string> to_table(const std::vector<std::string>& more) {
  return convert("out.csv", more);
}

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
  expect_refused(
      folder,
      std::vector<WrongCommand>{
          {"convert: variances", {"convert", "v.var.hdr", "out.hdr", "--quantity", "density"}, expected},
          {"sensor: variances", {"sensor", "v.var.hdr", "--png", "out.png"}, expected}});
}

TEST(WrongConversion, Options) {
  const TemporaryFolder folder;
  write_cubes(folder);
  expect_refused(
      folder,
      std::vector<WrongCommand>{
          {"convert: no output", {"convert", "cube.exr"}, "OUT is required (see kiloband convert --help)"},
          {"convert: nothing there",
           {"convert", "none.exr", "out.hdr"},
           "cannot open 'none.exr': No such file or directory"},
          {"convert: unknown input",
           {"convert", "scene.xml", "out.hdr"},
           "'scene.xml': cannot tell the format of a cube: must end in .exr, .hdr or .img (ENVI)"},
          {"convert: unknown output",
           {"convert", "cube.exr", "out.tif"},
           "'out.tif': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {"convert: --select 9", to_cube({"--select", "9"}),
           "band indices '9': the cube has 4 bands, counted from 0"},
          {"convert: --select x", to_cube({"--select", "x"}),
           "band indices 'x': must be a list such as 0-9,20"},
          {"convert: --select 1,1", to_cube({"--select", "1,1"}),
           "band indices '1,1': band 1 is given twice"},
          {"convert: --select ", to_cube({"--select", ""}), "band indices '': must be a list such as 0-9,20"},
          {"convert: --range 100-200", to_cube({"--range", "100-200"}), "no band lies inside 100-200 nm"},
          {"convert: --range red", to_cube({"--range", "red"}),
           "--range 'red': 'red': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
          {"convert: --rebin 400:700:3", to_cube({"--rebin", "400:700:3"}),
           "re-binning: channel 0 (400-500 nm) is not a union of whole channels: channel 1 (475-550 nm) "
           "reaches across 500 nm"},
          {"convert: --rebin 400:900:2", to_cube({"--rebin", "400:900:2"}),
           "re-binning: channel 0 (400-650 nm) is not a union of whole channels: channel 3 (625-700 nm) "
           "reaches across 650 nm"},
          {"convert: --rebin ", to_cube({"--rebin", ""}), "--rebin '': no channels"},
          {"convert: --crop 0,0,9,9", to_cube({"--crop", "0,0,9,9"}),
           "region 0,0,9,9: must lie in the image of 8x8 pixels"},
          {"convert: --crop 0,0,9", to_cube({"--crop", "0,0,9"}),
           "--crop 0,0,9: must be 4 whole numbers separated by commas"},
          {"convert: --crop -1,0,1,1", to_cube({"--crop", "-1,0,1,1"}),
           "--crop -1,0,1,1: must be 4 whole numbers separated by commas"},
          {"convert: --crop 4294967295,0,4294967295,1", to_cube({"--crop", "4294967295,0,4294967295,1"}),
           "region 4294967295,0,4294967295,1: must lie in the image of 8x8 pixels"},
          {"convert: --crop ", to_cube({"--crop", ""}),
           "--crop : must be 4 whole numbers separated by commas"},
          {"convert: --quantity flux", to_cube({"--quantity", "flux"}),
           "--quantity: flux not in {integral,density} (see kiloband convert --help)"},
          {"convert: --pixel 1,1", to_cube({"--pixel", "1,1"}),
           "--pixel, --region and --signature write CSV: the output must end in .csv"},
          {"convert: CSV of nothing", to_table({}),
           "CSV output needs --pixel X,Y, --region X,Y,WIDTH,HEIGHT or --signature"},
          {"convert: CSV --pixel 8,8", to_table({"--pixel", "8,8"}),
           "region 8,8,1,1: must lie in the image of 8x8 pixels"},
          {"convert: CSV --pixel 8", to_table({"--pixel", "8"}),
           "--pixel 8: must be 2 whole numbers separated by commas"},
          {"convert: CSV --pixel 1,", to_table({"--pixel", "1,"}),
           "--pixel 1,: must be 2 whole numbers separated by commas"},
          {"convert: CSV --region 7,7,2,2", to_table({"--region", "7,7,2,2"}),
           "region 7,7,2,2: must lie in the image of 8x8 pixels"},
      });
}

TEST(WrongConversion, DamagedCubes) {
  const TemporaryFolder folder;
  write_cubes(folder);
  const std::string exr = folder.read("cube.exr");
  const std::string header = folder.read("short.hdr");
  folder.write("truncated.exr", exr.substr(0, 2000));
  folder.write("empty.exr", "");
  folder.write("spoiled.exr", "x" + exr.substr(1));
  folder.write("short.img", std::string(100, '\0'));
  folder.write("long.hdr", header);
  folder.write("long.img", std::string(1028, '\0'));
  folder.write("nodata.hdr", header);
  folder.write("brace.hdr", header.substr(0, header.find("fwhm") + 12));
  folder.write("word.hdr", "word\n");
  std::string no_bands = header;
  folder.write("nobands.hdr", no_bands.replace(no_bands.find("bands = 4"), 9, "bands = 0"));
  expect_refused(
      folder,
      std::vector<WrongCommand>{
          {"convert: truncated.exr",
           {"convert", "truncated.exr", "out.exr"},
           "truncated.exr: the EXR file is incomplete: it ends before its last pixels"},
          {"convert: empty.exr",
           {"convert", "empty.exr", "out.exr"},
           "empty.exr: not a readable EXR file: the file ends too early"},
          {"convert: spoiled.exr",
           {"convert", "spoiled.exr", "out.exr"},
           "spoiled.exr: not a readable EXR file: it does not begin as one"},
          {"convert: nodata.hdr",
           {"convert", "nodata.hdr", "out.exr"},
           "'nodata.hdr': no data file 'nodata.img' beside it"},
          {"convert: short.hdr",
           {"convert", "short.hdr", "out.exr"},
           "short.img: the file has 100 bytes, its header needs 1024"},
          {"convert: long.hdr",
           {"convert", "long.hdr", "out.exr"},
           "long.img: the file has 1028 bytes, its header says 1024: it belongs to another header, or is "
           "damaged"},
          {"convert: brace.hdr", {"convert", "brace.hdr", "out.exr"}, "brace.hdr:13: fwhm: '{' without '}'"},
          {"convert: word.hdr",
           {"convert", "word.hdr", "out.exr"},
           "word.hdr:1: not an ENVI header: the first line must be 'ENVI'"},
          {"convert: nobands.hdr",
           {"convert", "nobands.hdr", "out.exr"},
           "nobands.hdr:5: bands '0': must be at least 1"},
      });
}

}  // namespace
}  // namespace kiloband::test
