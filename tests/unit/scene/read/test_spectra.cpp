// How numbers, colours and spectra are understood in reflectances and on emitters.
#include <gtest/gtest.h>

#include "spectral/colour/colour.hpp"
#include "spectral/colour/rgb.hpp"
#include "spectral/planck.hpp"
#include "support.hpp"

namespace kiloband::test::test_spectra {
namespace {

TEST(SceneSpectra, ReflectanceNumbersAreFlat) {
  for (const char* parameter :
       {R"(<float name="reflectance" value="0.25"/>)", R"(<rgb name="reflectance" value="0.25"/>)",
        R"(<spectrum name="reflectance" value="0.25"/>)",
        R"(<spectrum type="uniform" name="reflectance"><float name="value" value="0.25"/></spectrum>)"}) {
    const Spectrum s = reflectance(parameter);
    for (const double lambda : {200.0, 550.0, 12000.0}) EXPECT_DOUBLE_EQ(s(lambda), 0.25) << parameter;
  }
  EXPECT_EQ(reflectance("")(550), 0.5);
}

TEST(SceneSpectra, EmissionNumbersAreD65ButSpectraAreFlat) {
  for (const char* parameter :
       {R"(<float name="radiance" value="2"/>)", R"(<integer name="radiance" value="2"/>)",
        R"(<rgb name="radiance" value="2, 2, 2"/>)"}) {
    const Spectrum s = radiance(parameter);
    for (const double lambda : {400.0, 560.0, 700.0})
      EXPECT_NEAR(s(lambda), 2 * illuminant_d65()(lambda), 1e-12) << parameter;
    EXPECT_EQ(s(900), 0) << parameter;
  }
  EXPECT_EQ(radiance(R"(<spectrum name="radiance" value="2"/>)")(900), 2);
  EXPECT_EQ(radiance("")(560), illuminant_d65()(560));
}

TEST(SceneSpectra, ColoursAreUpsampled) {
  const Spectrum red = reflectance(R"(<rgb name="reflectance" value="0.8 0.1, 0.1"/>)");
  EXPECT_NEAR(red(620), rgb_reflectance({0.8, 0.1, 0.1})(620), 1e-12);
  EXPECT_GT(red(620), red(450));
  EXPECT_EQ(red(2000), red(830));  // reflectances continue with their end values ...
  const Spectrum light = radiance(R"(<rgb name="radiance" value="8 1 1"/>)");
  EXPECT_NEAR(light(620), rgb_emission({8, 1, 1})(620), 1e-12);
  EXPECT_EQ(light(2000), 0);  // ... and RGB emission ends where D65 does
}

TEST(SceneSpectra, PairsInterpolateAndAreZeroOutside) {
  const Spectrum s = reflectance(R"(<spectrum name="reflectance" value="400:0.1, 500:0.3 600:0.3"/>)");
  EXPECT_DOUBLE_EQ(s(450), 0.2);
  EXPECT_EQ(s(399), 0);
  EXPECT_EQ(s(601), 0);
}

TEST(SceneSpectra, RegularAndIrregular) {
  const std::string regular =
      R"(<spectrum type="regular" name="reflectance"><float name="wavelength_min" value="400"/>)"
      R"(<float name="wavelength_max" value="600"/><string name="values" value="0.1, 0.2 0.4"/>)";
  EXPECT_DOUBLE_EQ(reflectance(regular + "</spectrum>")(550), 0.3);
  EXPECT_EQ(reflectance(regular + "</spectrum>")(700), 0);
  EXPECT_EQ(reflectance(regular + R"(<boolean name="extrapolate" value="true"/></spectrum>)")(700), 0.4);
  const Spectrum irregular = reflectance(
      R"(<spectrum type="irregular" name="reflectance"><string name="wavelengths" value="400 500 700"/>)"
      R"(<string name="values" value="0.1, 0.2, 0.4"/></spectrum>)");
  EXPECT_DOUBLE_EQ(irregular(600), 0.3);
}

TEST(SceneSpectra, BlackbodyIsCutAndPlanckIsNot) {
  const std::string temperature = R"(<float name="temperature" value="3000"/></spectrum>)";
  const Spectrum cut = radiance(R"(<spectrum type="blackbody" name="radiance">)" + temperature);
  EXPECT_NEAR(cut(600) / planck_radiance(600, 3000), 1, 1e-12);
  EXPECT_EQ(cut(2000), 0);
  const Spectrum all =
      radiance(R"(<spectrum type="planck" name="radiance"><float name="scale" value="2"/>)" + temperature);
  EXPECT_NEAR(all(10000) / planck_radiance(10000, 3000), 2, 1e-12);
}

TEST(SceneSpectra, D65WithScaleColourAndNestedSpectrum) {
  const double d65 = illuminant_d65()(500);
  EXPECT_NEAR(
      radiance(R"(<spectrum type="d65" name="radiance"><float name="scale" value="3"/></spectrum>)")(500),
      3 * d65, 1e-12);
  EXPECT_NEAR(
      radiance(R"(<spectrum type="d65" name="radiance"><rgb name="color" value="2"/></spectrum>)")(500),
      2 * d65, 1e-12);
  for (const char* color : {R"(value="2")", R"(value="400:2, 600:2")",
                            R"(type="uniform"><float name="value" value="2"/></spectrum)"})
    EXPECT_NEAR(
        radiance(R"(<spectrum type="d65" name="radiance"><spectrum name="color" )" + std::string(color) +
                 (std::string_view(color).ends_with("spectrum") ? "></spectrum>" : "/></spectrum>"))(500),
        2 * d65, 1e-12)
        << color;
  EXPECT_NEAR(radiance(R"(<spectrum type="d65" name="radiance"><spectrum type="uniform" name="nested">)"
                       R"(<float name="value" value="0.5"/></spectrum></spectrum>)")(500),
              0.5 * d65, 1e-12);
  EXPECT_NEAR(
      radiance(R"(<spectrum type="srgb" name="radiance"><rgb name="color" value="0.5"/></spectrum>)")(500),
      0.5, 1e-12);
}

/// Mitsuba's plugin upsamples the colour itself; a multiple of a darker one has another spectrum, by 1 % here.
TEST(SceneSpectra, SrgbIsTheSameSpectrumEverywhere) {
  const std::string colour = R"(<rgb name="color" value="0.5, 0.4, 0.6"/></spectrum>)";
  const Spectrum expected = rgb_reflectance({0.5, 0.4, 0.6});
  const Spectrum lamp = radiance(R"(<spectrum type="srgb" name="radiance">)" + colour);
  const Spectrum wall = reflectance(R"(<spectrum type="srgb" name="reflectance">)" + colour);
  const Spectrum day =
      radiance(R"(<spectrum type="d65" name="radiance"><spectrum type="srgb" name="nested">)" + colour +
               "</spectrum>");
  for (const double lambda : {400.0, 450.0, 550.0, 620.0, 690.0}) {
    EXPECT_EQ(lamp(lambda), expected(lambda)) << lambda;
    EXPECT_EQ(wall(lambda), expected(lambda)) << lambda;
    EXPECT_NEAR(day(lambda), expected(lambda) * illuminant_d65()(lambda), 1e-9) << lambda;
  }
  // Brighter than any reflectance (ours): as much of the brightest one, so that no colour is far from its neighbours.
  const auto bright = [](const std::string& rgb) {
    return radiance(R"(<spectrum type="srgb" name="radiance"><rgb name="color" value=")" + rgb +
                    R"("/></spectrum>)");
  };
  EXPECT_NEAR(bright("2, 1, 1")(620), 2 * rgb_reflectance({1, 0.5, 0.5})(620), 1e-9);
  for (const double lambda : {400.0, 450.0, 550.0, 620.0, 690.0})
    EXPECT_NEAR(bright("1, 0.4, 0.6")(lambda), bright("1.0001, 0.4, 0.6")(lambda), 1e-3) << lambda;
}

TEST(SceneSpectra, FilesAreReadAndMayExtrapolate) {
  const TemporaryFolder folder;
  folder.write("leaf.spd", "# nm value\n400 0.1\n500 0.3\n");
  const auto read_one = [&](const std::string& parameter) {
    const auto result = read(scene(R"(<shape type="sphere"><bsdf type="diffuse">)" + parameter +
                                   "</bsdf></shape>" + kSensor + kLight),
                             folder.path());
    return std::get<Spectrum>(std::get<DiffuseBsdf>(result.shapes.at(0).bsdf->model).reflectance);
  };
  EXPECT_DOUBLE_EQ(read_one(R"(<spectrum name="reflectance" filename="leaf.spd"/>)")(450), 0.2);
  const std::string object =
      R"(<spectrum type="file" name="reflectance"><string name="filename" value="leaf.spd"/>)";
  EXPECT_EQ(read_one(object + "</spectrum>")(600), 0);
  EXPECT_EQ(read_one(object + R"(<boolean name="extrapolate" value="true"/></spectrum>)")(600), 0.3);
}

TEST(SceneSpectra, UnitsOfFilesFollowTheParameter) {
  const TemporaryFolder folder;
  folder.write("sun.csv", "wavelength_um,E (W/m2/um)\n0.4,1700\n0.8,1100\n");
  folder.write("bare.csv", "400,1\n800,2\n");
  const auto read_sun = [&](const std::string& file, std::vector<Diagnostic>& messages) {
    ReadOptions options;
    options.sink = [&](const Diagnostic& d) { messages.push_back(d); };
    const std::string spectrum = "<spectrum name='irradiance' filename='" + file + "'/></emitter>";
    const std::string light =
        "<emitter type='directional'><vector name='direction' value='0 0 -1'/>" + spectrum;
    return read_scene(folder.write("units.xml", scene(kSphere + kSensor + light + light)), options);
  };
  std::vector<Diagnostic> messages;
  const SceneDescription sunny = read_sun("sun.csv", messages);
  const auto& sun = std::get<DirectionalEmitter>(sunny.emitters.at(0).model);
  EXPECT_DOUBLE_EQ(sun.irradiance(400), 1.7);
  EXPECT_TRUE(messages.empty());
  read_sun("bare.csv", messages);
  ASSERT_EQ(messages.size(), 1u) << "once for two lights";
  EXPECT_EQ(messages[0].severity, Severity::kNote);
  EXPECT_EQ(messages[0].message,
            "wavelengths are read as nm, values as W m^-2 nm^-1: the file states no units");
}

TEST(SceneSpectra, QuantitiesAboveOneMayBeColours) {
  const SceneDescription result = read(complete_scene(
      R"(<shape type="disk"><bsdf type="conductor"><rgb name="eta" value="0.2 0.9 1.2"/><rgb name="k" value="4"/></bsdf></shape>)"));
  const auto& conductor = std::get<ConductorBsdf>(result.shapes.at(0).bsdf->model);
  EXPECT_EQ(conductor.k(1000), 4);
  EXPECT_NEAR(conductor.eta(620), rgb_reflectance({0.2 / 2.4, 0.9 / 2.4, 0.5}).scaled(2.4)(620), 1e-12);
}

}  // namespace
}  // namespace kiloband::test::test_spectra
