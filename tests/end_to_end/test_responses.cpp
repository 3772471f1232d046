// Sensor responses through the program, in a scene whose every pixel is known:
// an empty sky of 1 W m^-2 sr^-1 nm^-1.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

const std::string kSky = R"(<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>)";

/// `film` is what stands inside the film besides its size.
std::string sky_scene(const std::string& type, const std::string& film) {
  return scene_text(R"(<sensor type="perspective"><film type=")" + type +
                    R"("><integer name="width" value="4"/><integer name="height" value="3"/>)" + film +
                    "</film></sensor>\n" + kSky);
}

/// Largest error of the mean of a response that changes by `slope_per_nm` over `range_nm`, in sub-channels of
/// at most 5 nm: the 32 samples of a replicate are stratified in wavelength, so each is within 5 nm / 32 of
/// its stratum's centre.
double stratified_bound(double slope_per_nm, double range_nm) {
  return range_nm * slope_per_nm * 5.0 / 32;
}

void expect_band(const Cube& cube, std::size_t band, const std::string& name, double value, double bound) {
  ASSERT_LT(band, cube.info.bands.size());
  EXPECT_EQ(cube.info.bands[band].channel.name, name);
  for (std::size_t pixel = 0; pixel < cube.pixels(); ++pixel) {
    EXPECT_NEAR(cube.mean[pixel * cube.info.bands.size() + band], value, bound) << name;
  }
}

TEST(Responses, NamedBandsOfASpecfilm) {
  const TemporaryFolder folder;
  folder.write("scene.xml", sky_scene("specfilm", R"(
    <spectrum name="blue" value="400:1, 500:1"/>
    <spectrum name="ramp" value="500:0, 600:1"/>)"));
  const Outcome outcome = run_program(folder, quiet_render("scene.xml", {"--spp", "64", "--replicates", "2",
                                                                         "-o", "out.exr", "-o", "out.hdr"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* file : {"out.exr", "out.hdr"}) {
    const Cube cube = read_cube(folder / file);
    ASSERT_EQ(cube.info.bands.size(), 2u) << "sub-channels are not written";
    // A response of 1 is a channel: 100 nm of the sky, or its density.
    const bool density = cube.info.quantity == Quantity::kDensity;
    expect_band(cube, 0, "blue", density ? 1 : 100, 1e-4);
    expect_band(cube, 1, "ramp", 50, stratified_bound(0.01, 100));
    EXPECT_TRUE(cube.info.bands[1].derived);
  }
}

/// A band of the whole visible besides does not spoil the estimate of one of 1 nm, in any mode of wavelengths. The narrow one has 300 / 301
/// of it, 1.9934; a sample of the wide one that falls there, of 64 two at most, adds 1.9934 / 64.
TEST(Responses, AWideBandLeavesANarrowOneItsAccuracy) {
  const TemporaryFolder folder;
  folder.write("scene.xml", sky_scene("specfilm", R"(
    <spectrum name="all" value="400:1, 700:1"/>
    <spectrum name="line" value="470:2, 471:2"/>)"));
  for (const char* wavelengths : {"shared", "per-path"}) {
    for (const char* seed : {"1", "2", "3"}) {
      const Outcome outcome =
          run_program(folder, quiet_render("scene.xml", {"--spp", "64", "--replicates", "1", "--wavelengths",
                                                         wavelengths, "--seed", seed, "-o", "out.hdr"}));
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const Cube cube = read_cube(folder / "out.hdr");
      ASSERT_EQ(cube.info.bands.size(), 2u);
      expect_band(cube, 0, "all", 300, 1e-3);
      expect_band(cube, 1, "line", 2, 0.07);
    }
  }
}

TEST(Responses, CommandLineBandsBeatTheFilms) {
  const TemporaryFolder folder;
  folder.write("scene.xml", sky_scene("specfilm", R"(<spectrum name="ramp" value="500:0, 600:1"/>)"));
  ASSERT_EQ(
      run_program(folder, quiet_render("scene.xml", {"--spp", "4", "--bands", "400:700:3", "-o", "out.hdr"}))
          .code,
      0);
  const Cube cube = read_cube(folder / "out.hdr");
  ASSERT_EQ(cube.info.bands.size(), 3u);
  for (std::size_t band = 0; band < 3; ++band) expect_band(cube, band, "", 100, 1e-4);
}

TEST(Responses, FilesAreAccumulatedBesideTheChannels) {
  const TemporaryFolder folder;
  folder.write("scene.xml", sky_scene("hdrfilm", ""));
  folder.write("camera.csv", "wavelength_nm,wide,ramp\n400,1,0\n500,1,1\n");
  const Outcome outcome = run_program(
      folder, quiet_render("scene.xml", {"--spp", "64", "--replicates", "2", "--bands", "400:500:20",
                                         "--response", "camera.csv", "-o", "out.hdr", "--variance"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube cube = read_cube(folder / "out.hdr");
  ASSERT_EQ(cube.info.bands.size(), 22u);
  expect_band(cube, 20, "wide", 100, 1e-3);
  expect_band(cube, 21, "ramp", 50, stratified_bound(0.01, 100));
}

/// Programs that read ENVI take a band for what `wavelength` and `fwhm` say, not for the middle of the render.
TEST(Responses, BandsStateTheirOwnWavelengths) {
  const TemporaryFolder folder;
  folder.write("scene.xml", sky_scene("hdrfilm", ""));
  folder.write("camera.csv", "wavelength_nm,red,peak\n614,1,0\n648,1,1\n682,1,0\n");
  ASSERT_EQ(
      run_program(folder, quiet_render("scene.xml", {"--spp", "4", "--bands", "380:2540:2", "--response",
                                                     "camera.csv", "-o", "a.hdr", "-o", "a.exr"}))
          .code,
      0);
  ASSERT_EQ(run_program(folder, {"sensor", "a.hdr", "--response", "camera.csv", "-o", "b.hdr"}).code, 0);
  expect_text(folder.read("b.hdr"), "wavelength = {648, 648}\nfwhm = {68, 34}\n");
  for (const char* file : {"a.hdr", "a.exr", "b.hdr"}) {
    const std::vector<Band> bands = read_cube(folder / file).info.bands;
    const Channel &red = bands[bands.size() - 2].channel, &peak = bands.back().channel;
    EXPECT_EQ(red.min_nm, 614) << file;
    EXPECT_EQ(red.max_nm, 682) << file;
    EXPECT_EQ(peak.min_nm, 631) << file;
    EXPECT_EQ(peak.max_nm, 665) << file;
  }
}

/// Two channels from 400 to 500 nm, and a response that is 1 in a range.
Outcome render_response(const std::string& first_nm, const std::string& last_nm) {
  const TemporaryFolder folder;
  folder.write("scene.xml", sky_scene("hdrfilm", ""));
  folder.write("camera.csv", "wavelength_nm,wide\n" + first_nm + ",1\n" + last_nm + ",1\n");
  return run_program(folder, quiet_render("scene.xml", {"--spp", "4", "--bands", "400:500:2", "--response",
                                                        "camera.csv", "-o", "out.hdr"}));
}

TEST(Responses, PartOutsideTheChannelsIsAWarning) {
  const Outcome outcome = render_response("400", "800");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "warning: response 'wide': 75 % of its integral lies outside the channels\n");
}

/// As `sensor` has it: a band of zeros is no result.
TEST(Responses, WhollyOutsideTheChannelsIsAnError) {
  const Outcome outcome = render_response("700", "800");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "kiloband: response 'wide': is 0 in all channels\n");
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  folder.write("dark.csv", "wavelength_nm,dark\n400,0\n700,0\n");
  const Outcome dark = run_program(folder, quiet_render("scene.xml", {"--response", "dark.csv"}));
  EXPECT_EQ(dark.err, "kiloband: response 'dark': is 0 in all channels\n");
}

/// Micrometres taken for nanometres: an image of zeros without a word would be believed.
TEST(Responses, ChannelsFarFromLightAreAWarning) {
  const TemporaryFolder folder;
  folder.write("scene.xml", sky_scene("hdrfilm", ""));
  const Outcome outcome =
      run_program(folder, quiet_render("scene.xml", {"--spp", "1", "--bands", "8:12:4", "-o", "out.hdr"}));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(
      outcome.err.find("warning: channels from 8 to 12 nm: wavelengths are in nm, scenes are meant for 380 "
                       "to 20000 nm\n"),
      std::string::npos)
      << outcome.err;
}

/// Two bands that have names only, as films of responses and other programs' files have them.
void write_named_bands(const std::filesystem::path& file) {
  CubeInfo info;
  info.width = info.height = 1;
  info.bands = {{{0, 0, "red"}, true}, {{0, 0, "green"}, true}};
  const auto writer = create_cube_writer(file, info, 1);
  const std::vector<float> values = {3, 4};
  writer->write_rows({0, 1, values, {}, {}});
  writer->finish();
}

TEST(Responses, NamedBandsAreGivenWavelengths) {
  const TemporaryFolder folder;
  write_named_bands(folder / "named.exr");
  const auto convert = [&](const std::string& out, const std::string& wavelengths) {
    return run_program(folder, {"convert", "named.exr", out, "--wavelengths", wavelengths});
  };
  ASSERT_EQ(convert("part.hdr", "green=500-600").code, 0);
  const Cube part = read_cube(folder / "part.hdr");
  ASSERT_EQ(part.info.bands.size(), 2u);
  EXPECT_EQ(part.info.bands[0].channel.name, "green");  // bands with wavelengths come first
  EXPECT_EQ(part.info.bands[0].channel.min_nm, 500);
  EXPECT_EQ(part.info.bands[0].channel.max_nm, 600);
  EXPECT_FALSE(part.info.bands[0].derived);
  EXPECT_EQ(part.info.bands[1].channel.name, "red");
  EXPECT_TRUE(part.info.bands[1].derived);
  EXPECT_EQ(part.mean, (std::vector<float>{4, 3}));

  folder.write("bands.txt", "# of the sensor\nred = 600-700\ngreen=500-600\n");
  ASSERT_EQ(convert("all.exr", "bands.txt").code, 0);
  const Cube all = read_cube(folder / "all.exr");
  ASSERT_EQ(all.info.bands.size(), 2u);
  EXPECT_EQ(all.info.bands[0].channel.max_nm, 700);
  EXPECT_FALSE(all.info.bands[1].derived);

  const Outcome unknown = convert("x.exr", "blue=400-500");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err,
            "kiloband: wavelengths of band 'blue': the cube has no such band; without wavelengths are 'red', "
            "'green'\n");

  std::string many;  // longer than the name of a file can be
  for (int i = 0; i < 40; ++i) many += "band" + std::to_string(i) + "=400-500,";
  EXPECT_EQ(
      convert("x.exr", many + "red=600-700").err,
      "kiloband: wavelengths of band 'band0': the cube has no such band; without wavelengths are 'red', "
      "'green'\n");
}

}  // namespace
}  // namespace kiloband::test
