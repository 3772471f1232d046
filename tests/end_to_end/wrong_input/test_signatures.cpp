// Wrong command lines of `sensor` and of signatures.
#include <gtest/gtest.h>

#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test::test_signatures {
namespace {

/// cube.exr: 8 x 8 pixels, a sphere named 'ball', with auxiliary images; plain.exr without; flat.exr of a
/// parallel camera; foreign.hdr from elsewhere.
void write_cubes(const TemporaryFolder& folder) {
  folder.write(
      "scene.xml",
      scene_text(
          kSensor + kLight +
          R"(<shape type="sphere" id="ball"><transform name="to_world"><translate z="5"/></transform></shape>)"));
  folder.write(
      "flat.xml",
      scene_text(R"(<sensor type="orthographic"><film type="hdrfilm"><integer name="width" value="8"/>)"
                 R"(<integer name="height" value="8"/></film></sensor>)" +
                 kLight + kSphere));
  folder.write("response.csv", "wavelength_nm,r\n400,1\n700,1\n");
  folder.write("small.pgm", "P2\n2 2\n255\n0 0 0 0\n");
  const std::vector<std::string> channels{"--spp", "1", "--bands", "400:700:4", "-o"};
  const auto render = [&](const std::string& scene, const std::string& out, const std::string& aov) {
    std::vector<std::string> more = channels;
    more.push_back(out);
    if (!aov.empty()) more.insert(more.end(), {"--aov", aov});
    const Outcome outcome = run_program(folder, quiet_render(scene, more));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  };
  render("scene.xml", "cube.exr", "depth,object");
  render("scene.xml", "plain.exr", "");
  render("flat.xml", "flat.exr", "object");
  folder.write("foreign.img", std::string(4 * 8, '\0'));
  folder.write("foreign.hdr",
               "ENVI\nsamples = 2\nlines = 2\nbands = 2\nheader offset = 0\nfile type = ENVI Standard\n"
               "data type = 4\ninterleave = bsq\nbyte order = 0\nwavelength units = Nanometers\n"
               "wavelength = { 450, 550 }\nfwhm = { 100, 100 }\nkiloband quantity = integral\n");
}

TEST(WrongSignatures, Options) {
  const TemporaryFolder folder;
  write_cubes(folder);
  expect_refused(folder, {"convert", "cube.exr", "out.csv", "--signature"},
                 {
                     {{}, "--signature needs --object, --region or --mask"},
                     {{"--pixel", "1,1"}, "--pixel: a signature has --object, --region and --mask"},
                     {{"--object", "bal"}, "--object bal: no object 'bal'; did you mean 'ball'?"},
                     {{"--object", "7"}, "--object 7: is in no pixel"},
                     {{"--region", "0,0,1,1"}, "0,0,1,1: nothing is hit there: give --distance"},
                     {{"--object", "ball", "--distance", "0"}, "--distance 0: must be > 0 and finite"},
                     {{"--object", "ball", "--distance", "1e300"}, "--distance 1e+300: must be <= 1e+15 m"},
                     {{"--region", "7,7,2,2"}, "region 7,7,2,2: must lie in the image of 8x8 pixels"},
                     {{"--mask", "small.pgm"}, "--mask small.pgm: 2x2 pixels, the cube has 8x8"},
                     {{"--region", "0,0,8,8", "--distance", "5", "--background-ring", "1"},
                      "background: no pixel is left outside the masks"},
                     {{"--object", "ball", "--background-ring", "1", "--background", "plain.exr"},
                      "--background excludes --background-ring (see kiloband convert --help)"},
                 });
  const Outcome partly =
      run_program(folder, {"convert", "cube.exr", "out.csv", "--signature", "--object", "ball,7"});
  EXPECT_EQ(partly.code, 0);
  EXPECT_NE(partly.err.find("warning: --object ball,7: '7' is in no pixel"), std::string::npos) << partly.err;
  ASSERT_EQ(run_program(folder, quiet_render("scene.xml", {"--spp", "4", "--bands", "400:700:4", "--variance",
                                                           "-o", "var.hdr"}))
                .code,
            0);
  expect_refused(
      folder, {"convert", "cube.exr", "out.csv", "--signature", "--object", "ball"},
      {{{"--background", "var.var.hdr"},
        "var.var.hdr: holds variances, not radiances: give the cube itself, var.hdr, whose variances go with it"}});
  expect_refused(folder, {},
                 {
                     {{"convert", "cube.exr", "out.hdr", "--signature"},
                      "--pixel, --region and --signature write CSV: the output must end in .csv"},
                     {{"convert", "cube.exr", "out.csv", "--object", "ball"},
                      "--object requires --signature (see kiloband convert --help)"},
                 });
  expect_refused(
      folder, {"convert", "plain.exr", "out.csv", "--signature"},
      {
          {{"--object", "0"},
           "--object: the cube has no auxiliary image 'object': render it with --aov object"},
          {{"--region", "0,0,2,2"},
           "intensities need the distance of the object: give --distance, or render with --aov depth"},
      });
  expect_refused(folder, {"convert", "flat.exr", "out.csv", "--signature"},
                 {
                     {{"--object", "0", "--distance", "9"},
                      "--distance: the camera is orthographic: intensities do not depend on it"},
                 });
  expect_refused(
      folder, {"convert", "foreign.hdr", "out.csv", "--signature"},
      {
          {{"--region", "0,0,1,1"},
           "foreign.hdr: does not state its camera: signatures need a cube that kiloband rendered"},
      });
}

TEST(WrongSignatures, Sensor) {
  const TemporaryFolder folder;
  write_cubes(folder);
  expect_refused(folder, {},
                 {
                     {{"sensor"}, "CUBE is required (see kiloband sensor --help)"},
                 });
  expect_refused(folder, {"sensor", "cube.exr"},
                 {
                     {{"--response", "response.csv"}, "nothing to write: give -o or --png"},
                     {{"-o", "out.hdr"}, "-o needs --response"},
                     {{"--response", "xyz", "-o", "out.tif"},
                      "'out.tif': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
                     {{"--response", "xyz", "-o", "out.csv"},
                      "CSV output needs --pixel X,Y, --region X,Y,WIDTH,HEIGHT or --signature"},
                     {{"--response", "xyz", "-o", "out.exr", "--pixel", "0,0"},
                      "--pixel, --region and --signature write CSV: an output must end in .csv"},
                     {{"--png", "out.jpg"}, "--png out.jpg: must end in .png"},
                     {{"--png", "out.png", "--picture", "sensor"}, "--picture sensor needs --response"},
                     {{"--response", "xyz", "-o", "out.exr", "--picture", "false"},
                      "--picture requires --png (see kiloband sensor --help)"},
                     {{"--png", "out.png", "--exposure", "0"}, "--exposure 0: must be a number > 0"},
                     {{"--png", "out.png", "--exposure", "inf"}, "--exposure inf: must be a number > 0"},
                     {{"--png", "out.png", "--exposure", "1e300"}, "--exposure 1e+300: must be <= 1e+30"},
                 });
}

}  // namespace
}  // namespace kiloband::test::test_signatures
