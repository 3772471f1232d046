// sunsky: two emitters of our own clear sky, with Mitsuba's parameters and orientation.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "sky/sky_map.hpp"
#include "support.hpp"

namespace kiloband::test::test_sunsky {
namespace {

std::vector<Emitter> emitters_of(const std::string& contents, Messages* messages = nullptr) {
  Messages own;
  return read(scene("<emitter type='sunsky'>" + contents + "</emitter>" + kSensor + kSphere), "/nonexistent",
              {}, (messages ? *messages : own).lines())
      .emitters;
}

std::string direction(const std::string& xyz) {
  return "<vector name='sun_direction' value='" + xyz + "'/>";
}

std::string number(const std::string& name, const std::string& value) {
  return "<float name='" + name + "' value='" + value + "'/>";
}

/// The world direction in which the map is brightest, at 550 nm.
glm::dvec3 brightest(const SpectralEnvmapEmitter& sky) {
  const SpectralImage& image = *sky.image;
  std::size_t band = 0, best = 0;
  while (image.bands[band].centre_nm() < 550) ++band;
  const auto value = [&](std::size_t texel) {
    return (*image.values)[texel * image.values_per_pixel + band];
  };
  for (std::size_t i = 0; i < std::size_t{image.width} * image.height; ++i)
    if (value(i) > value(best)) best = i;
  const double u = (static_cast<double>(best % image.width) + 0.5) / image.width;
  const double v = static_cast<double>(best / image.width) / (image.height - 1);
  const double phi = 2 * glm::pi<double>() * u, theta = glm::pi<double>() * v;
  const glm::dvec3 local(std::sin(phi) * std::sin(theta), std::cos(theta), -std::cos(phi) * std::sin(theta));
  return glm::dmat3(sky.to_world) * local;
}

TEST(SceneSunsky, IsASkyAndASun) {
  Messages messages;
  const auto emitters = emitters_of(direction("0.48, 0.64, 0.6"), &messages);
  ASSERT_EQ(emitters.size(), 2u);
  const auto& sky = std::get<SpectralEnvmapEmitter>(emitters[0].model);
  const auto& sun = std::get<DirectionalEmitter>(emitters[1].model);
  EXPECT_NEAR(glm::length(sun.direction + glm::dvec3(0.48, 0.64, 0.6)), 0, 1e-12);
  EXPECT_NEAR(sun.angular_radius, 0.5358 / 2 * kDegree, 1e-12);
  EXPECT_EQ(sky.scale, 1);
  EXPECT_GT(glm::dot(brightest(sky), glm::dvec3(0.48, 0.64, 0.6)), std::cos(6 * kDegree));
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "scene.xml:2:2: note: sunsky emitter: the sky is kiloband's own model, see docs/sky_model.md");
}

/// Turbidity 3 is an optical depth of 0.2275 at 500 nm; nothing shines from below.
TEST(SceneSunsky, IsTheClearSkyOfItsTurbidity) {
  const auto emitters = emitters_of(direction("0.8, 0, 0.6") + number("albedo", "0.25"));
  SkyParameters parameters;
  parameters.sun_elevation_deg = std::asin(0.6) / kDegree;
  parameters.aerosol_500nm = (0.04608 * 3 - 0.04586) * std::pow(0.5, -1.3);
  parameters.ground_albedo = 0.25;
  EXPECT_NEAR(parameters.aerosol_500nm, 0.2275, 1e-4);
  const ClearSky model(parameters);
  const auto& sun = std::get<DirectionalEmitter>(emitters[1].model);
  for (const double nm : {455.0, 555.0, 705.0})  // middles of bands
    EXPECT_NEAR(sun.irradiance(nm) / model.direct_normal()(nm), 1, 0.02) << nm;
  const SpectralImage& image = *std::get<SpectralEnvmapEmitter>(emitters[0].model).image;
  const std::size_t row = std::size_t{image.width} * image.values_per_pixel, horizon = image.height / 2;
  double above = 0, below = 0;
  for (std::size_t i = 0; i < image.values->size(); ++i)
    (i < (horizon + 1) * row ? above : below) += (*image.values)[i];
  EXPECT_GT(above, 0);
  EXPECT_EQ(below, 0);
}

std::string turned(const std::string& steps) {
  return "<transform name='to_world'>" + steps + "</transform>";
}

/// to_world turns the sky; sun_direction stands in the world, as Mitsuba 3.9.1's eval() and sample_direction() have it.
/// Local up is towards (0, 1, 0), (sin 20, 0, cos 20 degrees) turned by 70 about z, (0, 0.6, 0.8).
TEST(SceneSunsky, SunDirectionStandsInTheWorld) {
  const glm::dvec3 towards = glm::normalize(glm::dvec3(0.3, 0.6, 0.6));
  const double c = std::cos(20 * kDegree), s = std::sin(20 * kDegree), phi = 70 * kDegree;
  const std::pair<std::string, glm::dvec3> cases[] = {
      {"<rotate x='1' angle='-90'/>", {0, 1, 0}},
      {"<rotate y='1' angle='20'/><rotate z='1' angle='70'/>", {s * std::cos(phi), s * std::sin(phi), c}},
      {"<scale x='-2' y='2' z='2'/><rotate x='1' angle='-36.86989764584402'/>", {0, 0.6, 0.8}}};
  for (const auto& [steps, up] : cases) {
    SCOPED_TRACE(steps);
    const auto emitters = emitters_of(direction("0.3, 0.6, 0.6") + turned(steps));
    const auto& sun = std::get<DirectionalEmitter>(emitters[1].model);
    EXPECT_NEAR(glm::length(sun.direction + towards), 0, 1e-9);
    EXPECT_GT(glm::dot(brightest(std::get<SpectralEnvmapEmitter>(emitters[0].model)), towards),
              std::cos(6 * kDegree));
    SkyParameters parameters;  // of the sun over the local horizon
    parameters.sun_elevation_deg = std::asin(glm::dot(up, towards)) / kDegree;
    parameters.aerosol_500nm = (0.04608 * 3 - 0.04586) * std::pow(0.5, -1.3);
    EXPECT_NEAR(sun.irradiance(555) / ClearSky(parameters).direct_normal()(555), 1, 0.02);
  }
  EXPECT_NE(error_of(scene("<emitter type='sunsky'>" + direction("0, 0, 1") +
                           turned("<rotate x='1' angle='100'/>") + "</emitter>" + kSensor + kSphere))
                .find("the sun is not above the horizon"),
            std::string::npos);
}

TEST(SceneSunsky, TheSunOfATimeTurnsWithTheTransform) {
  const auto sun = std::get<DirectionalEmitter>(emitters_of("")[1].model).direction;
  const auto other =
      std::get<DirectionalEmitter>(emitters_of(turned("<scale x='-1'/><rotate x='1' angle='-90'/>"))[1].model)
          .direction;
  EXPECT_NEAR(glm::length(other - glm::dvec3(-sun.x, sun.z, -sun.y)), 0, 1e-12);
}

/// Mitsuba's default: Tokyo, 10 July 2010, 15 h.
TEST(SceneSunsky, PlaceAndTime) {
  const auto sun = std::get<DirectionalEmitter>(emitters_of("")[1].model).direction;
  EXPECT_GT(glm::dot(-sun, glm::dvec3(0.0513854, 0.691748, 0.720308)), std::cos(0.06 * kDegree));
  const auto other = std::get<DirectionalEmitter>(
      emitters_of(number("latitude", "48") + number("longitude", "2") + number("timezone", "2") +
                  "<integer name='year' value='2020'/><integer name='month' value='3'/>"
                  "<integer name='day' value='20'/>" +
                  number("hour", "10"))[1]
          .model);
  EXPECT_GT(glm::dot(-other.direction, glm::dvec3(0.372857, -0.86471, 0.336533)), std::cos(0.05 * kDegree));
}

TEST(SceneSunsky, ScalesLeaveOneOut) {
  const auto sky = emitters_of(number("sun_scale", "0") + number("sky_scale", "2"));
  ASSERT_EQ(sky.size(), 1u);
  EXPECT_EQ(std::get<SpectralEnvmapEmitter>(sky[0].model).scale, 2);
  const auto sun = emitters_of(number("sky_scale", "0") + number("sun_scale", "3"));
  ASSERT_EQ(sun.size(), 1u);
  const auto once = emitters_of("");
  EXPECT_NEAR(std::get<DirectionalEmitter>(sun[0].model).irradiance(555) /
                  std::get<DirectionalEmitter>(once[1].model).irradiance(555),
              3, 1e-9);
}

TEST(SceneSunsky, Errors) {
  const auto message = [](const std::string& contents) {
    return error_of(scene("<emitter type='sunsky'>" + contents + "</emitter>" + kSensor + kSphere));
  };
  EXPECT_NE(message(direction("1, 0, -0.1")).find("sunsky emitter: the sun is not above the horizon"),
            std::string::npos);
  EXPECT_NE(message(number("turbidity", "11")).find("turbidity 11: must be from 1 to 10"), std::string::npos);
  EXPECT_NE(message(direction("1, 0, 1") + number("hour", "3")).find("'hour' together with 'sun_direction'"),
            std::string::npos);
  EXPECT_NE(message(number("sky_scale", "0") + number("sun_scale", "0")).find("there is no light"),
            std::string::npos);
  EXPECT_NE(message("<integer name='month' value='2'/><integer name='day' value='30'/>")
                .find("day: the month has no such day"),
            std::string::npos);
  EXPECT_NE(error_of(scene("<emitter type='sunsky'/><emitter type='constant'/>" + kSensor + kSphere))
                .find("a second environment"),
            std::string::npos);
}

}  // namespace
}  // namespace kiloband::test::test_sunsky
