// Files of Mitsuba 0.x: elements and parameters that newer versions no longer have.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/scene/read/support.hpp"

namespace kiloband::test::test_old_files {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

std::string old_scene(const std::string& body) {
  return "<scene version=\"0.6.0\">\n" + body + "\n</scene>\n";
}

std::vector<std::string> messages_of(const std::string& text, SceneDescription& scene) {
  Messages messages;
  scene = read(text, "/nonexistent", {}, messages.lines());
  return messages.texts;
}

Spectrum old_reflectance(const std::string& element) {
  const SceneDescription scene = read(old_scene(R"(<shape type="sphere"><bsdf type="diffuse">)" + element +
                                                "</bsdf></shape>" + kSensor + kLight));
  return std::get<Spectrum>(std::get<DiffuseBsdf>(scene.shapes.at(0).bsdf->model).reflectance);
}

TEST(OldFiles, SrgbIsDecoded) {
  EXPECT_NEAR(old_reflectance(R"(<srgb name="reflectance" value="#808080"/>)")(550), 0.215861, 1e-6);
  EXPECT_NEAR(old_reflectance(R"(<srgb name="reflectance" value="0.5"/>)")(550), 0.214041, 1e-6);
  const Spectrum red = old_reflectance(R"(<srgb name="reflectance" value="#ff4040"/>)");
  EXPECT_GT(red(650), red(450));
  EXPECT_EQ(
      error_of(old_scene(
          R"(<shape type="sphere"><bsdf type="diffuse"><srgb name="reflectance" value="#80808"/></bsdf></shape>)")),
      "scene.xml:2:75: error: <srgb>: '#80808' is not a colour such as #8899aa");
  EXPECT_EQ(error_of(scene(R"(<srgb name="reflectance" value="#808080"/>)")),
            "scene.xml:2:2: error: unknown element <srgb>; did you mean 'rgb'?");
}

TEST(OldFiles, BlackBodiesAreElements) {
  const SceneDescription scene = read(old_scene(
      R"(<emitter type="constant"><blackbody name="radiance" temperature="3000K" scale="0.5"/></emitter>)" +
      kSensor + kSphere));
  const auto& constant = std::get<ConstantEmitter>(scene.emitters.at(0).model);
  for (const double nm : {300.0, 550.0, 2000.0})
    EXPECT_EQ(constant.radiance(nm), Spectrum::planck(3000, 0.5)(nm));
  EXPECT_EQ(error_of(old_scene(
                R"(<emitter type="constant"><blackbody name="radiance" temperature="hot"/></emitter>)" +
                kSensor + kSphere)),
            "scene.xml:2:66: error: planck spectrum: temperature: 'hot' is not a number");
}

TEST(OldFiles, FilmsOfPicturesAreFilms) {
  SceneDescription scene;
  const auto told = messages_of(
      old_scene(
          R"(<sensor type="perspective"><film type="ldrfilm"><integer name="width" value="7"/><float name="gamma" value="2.2"/></film></sensor>)" +
          kLight + kSphere),
      scene);
  EXPECT_EQ(scene.sensor.film.width, 7u);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0], "scene.xml:2:40: note: ldrfilm film: read as an hdrfilm; --preview writes a picture");
  EXPECT_EQ(told[1],
            "scene.xml:2:95: warning: ldrfilm film: parameter 'gamma' of old files has no meaning here");
}

TEST(OldFiles, ParametersWithoutMeaningAreWarnings) {
  SceneDescription scene;
  const auto told = messages_of(
      old_scene(R"(<integrator type="path"><boolean name="strictNormals" value="true"/></integrator>)" +
                kSensor + kLight + kSphere),
      scene);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(
      told[0],
      "scene.xml:2:40: warning: path integrator: parameter 'strict_normals' of old files has no meaning here");
}

TEST(OldFiles, ConductorsStandInAir) {
  const auto metal = [](const std::string& ext) {
    return old_scene(R"(<bsdf type="roughconductor"><float name="extEta" value=")" + ext + R"("/></bsdf>)" +
                     kSensor + kLight + kSphere);
  };
  EXPECT_EQ(error_of(metal("1")), "accepted");
  EXPECT_EQ(error_of(metal("1.000277")), "accepted");
  EXPECT_EQ(
      error_of(metal("1.33")),
      "scene.xml:2:57: error: roughconductor bsdf: ext_eta 1.33: conductors stand in air here (1): divide eta and k by it");
}

std::vector<Emitter> old_sky(const std::string& type, const std::string& contents) {
  return read(old_scene("<emitter type='" + type + "'>" + contents + "</emitter>" + kSensor + kSphere))
      .emitters;
}

glm::dvec3 towards_sun(const std::vector<Emitter>& emitters) {
  return -std::get<DirectionalEmitter>(emitters.back().model).direction;
}

// Up is +Y: where the map's zenith is in the world, and the sun as it is given.
TEST(OldFiles, SkiesHaveYUp) {
  const std::string direction = "<vector name='sunDirection' x='0.48' y='0.6' z='-0.64'/>";
  const auto emitters = old_sky("sunsky", direction);
  ASSERT_EQ(emitters.size(), 2u);
  EXPECT_NEAR(glm::length(towards_sun(emitters) - glm::dvec3(0.48, 0.6, -0.64)), 0, 1e-12);
  const glm::dmat3 sky(std::get<SpectralEnvmapEmitter>(emitters[0].model).to_world);
  EXPECT_NEAR(glm::length(sky * glm::dvec3(0, 1, 0) - glm::dvec3(0, 1, 0)), 0, 1e-12);
  // sun_direction stands in the world, whatever the transform is
  const auto turned =
      old_sky("sunsky", direction + "<transform name='toWorld'><rotate y='1' angle='40'/></transform>");
  EXPECT_NEAR(glm::length(towards_sun(turned) - glm::dvec3(0.48, 0.6, -0.64)), 0, 1e-12);
}

// +X is east, +Z south: at noon in Tokyo the sun is in the south, in the afternoon in the west.
TEST(OldFiles, TimesGiveASunInTheSouthAtNoon) {
  const glm::dvec3 noon = towards_sun(old_sky("sun", "<float name='hour' value='11.7'/>"));
  EXPECT_GT(noon.y, 0.95);
  EXPECT_GT(noon.z, 0.1);
  EXPECT_LT(towards_sun(old_sky("sun", "<float name='hour' value='16'/>")).x, -0.6);
}

TEST(OldFiles, SunAndSkyAreOneEmitterEach) {
  const auto sky = old_sky("sky", "<float name='scale' value='2'/>");
  ASSERT_EQ(sky.size(), 1u);
  EXPECT_EQ(std::get<SpectralEnvmapEmitter>(sky[0].model).scale, 2);
  const auto sun = old_sky("sun", "<float name='sunRadiusScale' value='3'/>");
  ASSERT_EQ(sun.size(), 1u);
  EXPECT_NEAR(std::get<DirectionalEmitter>(sun[0].model).angular_radius, 3 * 0.5358 / 2 * kDegree, 1e-12);
}

}  // namespace
}  // namespace kiloband::test::test_old_files
