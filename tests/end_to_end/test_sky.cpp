// kiloband sky: the map, its use as an environment, wrong options.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sky/clear_sky.hpp"
#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test {
namespace {

/// A horizontal square under the map, seen from above.
const std::string kField =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='2'/></integrator>"
    "<sensor type='orthographic'><transform name='to_world'><lookat origin='0,5,0' target='0,0,0' "
    "up='0,0,1'/>"
    "</transform><film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='32'/>"
    "<rfilter type='box'/></film></sensor><shape type='rectangle'><transform name='to_world'><rotate x='1' "
    "angle='-90'/><scale value='3'/></transform><bsdf type='diffuse'><spectrum name='reflectance' "
    "value='0.5'/>"
    "</bsdf></shape><emitter type='spectral_envmap'><string name='filename' "
    "value='sky.exr'/></emitter></scene>";

/// The field shows albedo / pi times the global irradiance, in sunlight and in the thermal infrared. 65 536
/// samples: the standard error is 0.3 %, 2 % would be missed once in a billion runs.
class SkyTest : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Suns, SkyTest, ::testing::Bool(),
                         [](const auto& apart) { return apart.param ? "SunApart" : "SunInTheMap"; });

TEST_P(SkyTest, LightsAFieldAsTheModelSays) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {
      "sky",         "sky.exr",
      "--elevation", "35",
      "--azimuth",   "120",
      "--size",      "64x33",
      "--bands",     "500-510, 540-560, 560-580, 8000-9000, 9000-10000, 10000-11000",
      "--preview",   "sky.png"};
  if (GetParam()) arguments.insert(arguments.end(), {"--sun", "sun.xml"});
  const Outcome sky = run_program(folder, arguments);
  ASSERT_EQ(sky.code, 0) << sky.err;
  const std::string written = GetParam() ? "wrote sky.exr\nwrote sky.png\nwrote sun.xml\nin 6 b"
                                         : "wrote sky.exr\nwrote sky.png\nin 6 b";
  EXPECT_EQ(sky.err.substr(0, written.size()), written) << sky.err;
  std::string field = kField;
  if (GetParam()) field.insert(field.rfind("<emitter"), "<include filename='sun.xml'/>");
  folder.write("field.xml", field);
  const Outcome outcome = run_program(folder, quiet_render("field.xml", {"--bands", "545-555, 9000-10000",
                                                                         "--spp", "64", "-o", "field.hdr"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube cube = read_cube(folder / "field.hdr");
  double mean[2] = {};
  for (std::size_t i = 0; i < cube.mean.size(); ++i)
    mean[i % 2] += cube.mean[i] / static_cast<double>(cube.pixels());
  const ClearSky model({.sun_elevation_deg = 35, .sun_azimuth_deg = 120});
  const double up = std::sin(35 * std::numbers::pi / 180);
  const auto irradiance = [&](double low, double high) {
    return model.direct_normal().mean(low, high) * up + model.rayleigh().mean(low, high) +
           model.aerosol().mean(low, high) + model.reflected().mean(low, high) +
           model.thermal_irradiance(low, high) / (high - low);
  };
  // Between band centres the map is linear in wavelength: 550 is a centre, 505 and 570 are the next ones; the
  // whole of a band among equal ones sees an eighth of each neighbour.
  const double visible = 0.5 * (0.9444 * irradiance(540, 560) + 0.0556 * irradiance(500, 510)) +
                         0.5 * (0.875 * irradiance(540, 560) + 0.125 * irradiance(560, 580));
  const double infrared =
      (irradiance(8000, 9000) + 6 * irradiance(9000, 10000) + irradiance(10000, 11000)) / 8;
  EXPECT_NEAR(mean[0] / (0.5 / std::numbers::pi * 10 * visible), 1, 0.02);
  EXPECT_NEAR(mean[1] / (0.5 / std::numbers::pi * 1000 * infrared), 1, 0.02);
}

/// The sun's scene names the map in a comment, which "--" and stray bytes would spoil.
TEST(Sky, SunsOfMapsOfAnyNameCanBeRead) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene("<include filename='sun.xml'/>"));
  for (const char* name : {"my--sky --->.exr",
                           "m\xe4"
                           "rz\n.exr",
                           "m\xc3\xa4"
                           "rz.exr"}) {
    const Outcome sky =
        run_program(folder, {"sky", name, "--sun", "sun.xml", "--size", "8x5", "--bands", "500:600:2"});
    ASSERT_EQ(sky.code, 0) << sky.err;
    const Outcome info = run_program(folder, {"info", "scene.xml"});
    EXPECT_EQ(info.code, 0) << info.err;
  }
  EXPECT_NE(folder.read("sun.xml").find("m\xc3\xa4"
                                        "rz.exr"),
            std::string::npos);
}

TEST(Sky, WritesEnviDensities) {
  const TemporaryFolder folder;
  const Outcome sky = run_program(folder, {"sky", "sky.hdr", "--size", "16x9"});
  ASSERT_EQ(sky.code, 0) << sky.err;
  const Cube cube = read_cube(folder / "sky.hdr");
  EXPECT_EQ(cube.info.quantity, Quantity::kDensity);
  EXPECT_EQ(cube.info.bands.size(), 166u);
  EXPECT_EQ(cube.info.bands.front().channel.min_nm, 380);
  EXPECT_EQ(cube.info.metadata.at("sky").substr(0, 46), "clear sky: sun elevation 45 azimuth 180 degree");
  for (const float value : cube.mean) ASSERT_TRUE(value >= 0 && std::isfinite(value));
}

TEST(Sky, RefusesWrongOptions) {
  const TemporaryFolder folder;
  expect_refused(
      folder, {"sky"},
      {
          {{"sky.png"}, "'sky.png': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {{"a.exr", "--elevation", "100"}, "sun elevation 100: must be from -90 to 90 degrees"},
          {{"a.exr", "--sun", "s.xml", "--elevation", "0"},
           "--sun with --elevation 0: the sun is not above the horizon"},
          {{"a.hdr", "--sun", "a.img"}, "--sun a.img: another output has this name"},
          {{"a.exr", "--size", "16x10"},
           "sky height 10: must be odd and from 5 to 65535, so that a row lies on the horizon"},
          {{"a.exr", "--size", "16"}, "--size 16: must be WIDTHxHEIGHT, for example 640x480"},
          {{"a.exr", "--bands", "200:300:4"}, "sky band 200-225 nm: the model goes from 300 to 100000 nm"},
          {{"a.hdr", "--preview", "a.img"}, "--preview a.img: another output has this name"},
          {{"a.hdr", "--preview", "a.jpg"}, "--preview a.jpg: must end in .png"},
          {{"a.exr", "--bands", "400:500:4", "--bands-file", "b.csv"}, "--bands together with --bands-file"},
      });
}

}  // namespace
}  // namespace kiloband::test
