// Emitters and integrators.
#include <gtest/gtest.h>

#include <numbers>

#include "spectral/colour/colour.hpp"
#include "support.hpp"

namespace kiloband::test::test_emitters {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

template <typename Model>
Model emitter_of(const std::string& emitter, const std::filesystem::path& folder = "/nonexistent") {
  return std::get<Model>(read(scene(emitter + kSensor + kSphere), folder).emitters.at(0).model);
}

TEST(SceneEmitter, PointTakesPositionOrTransform) {
  EXPECT_EQ(
      emitter_of<PointEmitter>(R"(<emitter type="point"><point name="position" value="1 2 3"/></emitter>)")
          .position,
      glm::dvec3(1, 2, 3));
  EXPECT_EQ(
      emitter_of<PointEmitter>(
          R"(<emitter type="point"><transform name="to_world"><translate y="4"/></transform></emitter>)")
          .position,
      glm::dvec3(0, 4, 0));
}

TEST(SceneEmitter, SpotAngles) {
  const auto spot = emitter_of<SpotEmitter>(R"(<emitter type="spot"/>)");
  EXPECT_NEAR(spot.cutoff_angle, 20 * kDegree, 1e-15);
  EXPECT_NEAR(spot.beam_width, 15 * kDegree, 1e-15);
  EXPECT_EQ(spot.intensity(560), illuminant_d65()(560));
}

/// Two by one values.
void write_picture(const TemporaryFolder& folder) {
  folder.write("picture.ppm", "P3\n2 1\n255\n0 0 0 255 255 255\n");
}

TEST(SceneEmitter, SpotsMayHaveATexture) {
  EXPECT_FALSE(emitter_of<SpotEmitter>(R"(<emitter type="spot"/>)").texture);
  const TemporaryFolder folder;
  write_picture(folder);
  const auto spot = emitter_of<SpotEmitter>(
      R"(<emitter type="spot"><texture name="texture" type="bitmap"><string name="filename" value="picture.ppm"/></texture></emitter>)",
      folder.path());
  ASSERT_TRUE(spot.texture);
  EXPECT_EQ(std::get<std::shared_ptr<const BitmapTexture>>(*spot.texture)->image->width, 2u);
  EXPECT_EQ(spot.intensity(560), illuminant_d65()(560));
}

/// As wide as the field of view says, as high as the picture's pixels do.
TEST(SceneEmitter, ProjectorsFieldOfView) {
  const TemporaryFolder folder;
  write_picture(folder);
  const auto projector = [&](const std::string& parameters) {
    return emitter_of<ProjectorEmitter>(
        R"(<emitter type="projector"><texture name="irradiance" type="bitmap"><string name="filename" value="picture.ppm"/></texture>)" +
            parameters + "</emitter>",
        folder.path());
  };
  const auto wide = projector(R"(<float name="fov" value="90"/><float name="scale" value="3"/>)");
  EXPECT_NEAR(wide.tan_half_x, 1, 1e-12);
  EXPECT_NEAR(wide.tan_half_y, 0.5, 1e-12);
  EXPECT_EQ(wide.scale, 3);
  EXPECT_FALSE(wide.d65);
  const auto high = projector(R"(<float name="fov" value="90"/><string name="fov_axis" value="y"/>)");
  EXPECT_NEAR(high.tan_half_x, 2, 1e-12);
  EXPECT_NEAR(high.tan_half_y, 1, 1e-12);
  const auto square = emitter_of<ProjectorEmitter>(
      R"(<emitter type="projector"><spectrum name="irradiance" value="2"/><float name="fov" value="90"/></emitter>)");
  EXPECT_NEAR(square.tan_half_y, 1, 1e-12);
}

TEST(SceneEmitter, DirectionalIsNormalised) {
  EXPECT_EQ(emitter_of<DirectionalEmitter>(
                R"(<emitter type="directional"><vector name="direction" value="0 -5 0"/></emitter>)")
                .direction,
            glm::dvec3(0, -1, 0));
  const auto turned = emitter_of<DirectionalEmitter>(
      R"(<emitter type="directional"><transform name="to_world"><rotate y="1" angle="90"/><scale value="7"/></transform></emitter>)");
  EXPECT_NEAR(turned.direction.x, 1, 1e-12);
}

TEST(SceneEmitter, SunsHaveAnAngularRadius) {
  const auto sun = emitter_of<DirectionalEmitter>(
      R"(<emitter type="directional"><float name="angular_radius" value="0.2666"/></emitter>)");
  EXPECT_NEAR(sun.angular_radius, 0.2666 * kDegree, 1e-15);
  EXPECT_EQ(emitter_of<DirectionalEmitter>(R"(<emitter type="directional"/>)").angular_radius, 0);
  // It is seen: a scene may have nothing else.
  EXPECT_TRUE(read(scene(R"(<emitter type="directional"><float name="angular_radius" value="5"/></emitter>)" +
                         kSensor))
                  .shapes.empty());
}

TEST(SceneEmitter, EnvironmentMapIsLoaded) {
  const TemporaryFolder folder;
  folder.write("sky.ppm", "P3\n2 2\n255\n0 0 0 255 255 255 255 0 0 0 0 255\n");
  const auto envmap = emitter_of<EnvmapEmitter>(
      R"(<emitter type="envmap"><string name="filename" value="sky.ppm"/><float name="scale" value="2.5"/></emitter>)",
      folder.path());
  EXPECT_EQ(envmap.scale, 2.5);
  ASSERT_TRUE(envmap.image);
  EXPECT_EQ(envmap.image->width, 2u);
  EXPECT_EQ(envmap.image->pixels[3], 1);
}

TEST(SceneEmitter, WhatIsNotReadSaysWhatToUse) {
  const auto message = [](const std::string& type) {
    return error_of(scene("<emitter type='" + type + "'/>" + kSensor + kSphere));
  };
  EXPECT_EQ(
      message("sun"),
      "scene.xml:2:16: error: emitter type 'sun' is not supported: it is read in files of versions below 2; "
      "use sunsky with sky_scale 0");
  for (const char* type : {"sky", "timed_sunsky"})
    EXPECT_NE(message(type).find("use sunsky"), std::string::npos) << type;
  EXPECT_NE(message("directionalarea").find("no path from a camera finds"), std::string::npos);
}

TEST(SceneEmitter, SamplingWeightIsNoted) {
  Messages messages;
  read(scene(R"(<emitter type="point"><float name="sampling_weight" value="2"/></emitter>)" + kSensor +
             kSphere),
       "/nonexistent", {}, messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "scene.xml:2:60: note: point emitter: 'sampling_weight' has no meaning here: lights are chosen "
            "by their power");
}

TEST(SceneIntegrator, DefaultsAndPath) {
  const Integrator none = read(complete_scene("")).integrator;
  EXPECT_EQ(none.max_depth, -1);
  EXPECT_EQ(none.rr_depth, 5);
  EXPECT_FALSE(none.hide_emitters);
  const Integrator path =
      read(
          complete_scene(
              R"(<integrator type="path"><integer name="max_depth" value="0"/>)"
              R"(<integer name="rr_depth" value="7"/><boolean name="hide_emitters" value="true"/></integrator>)"))
          .integrator;
  EXPECT_EQ(path.max_depth, 0);
  EXPECT_EQ(path.rr_depth, 7);
  EXPECT_TRUE(path.hide_emitters);
}

TEST(SceneIntegrator, DirectSplitsSamples) {
  const auto samples = [](const std::string& parameters) {
    const SceneDescription result = read(scene(
        R"(<sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="10"/></sampler></sensor>)"
        R"(<integrator type="direct">)" +
        parameters + "</integrator>" + kLight));
    EXPECT_EQ(result.integrator.max_depth, 2);
    return result.sensor.sample_count;
  };
  EXPECT_EQ(samples(""), 10u);
  EXPECT_EQ(samples(R"(<integer name="shading_samples" value="3"/>)"), 30u);
  EXPECT_EQ(samples(R"(<integer name="emitter_samples" value="4"/><integer name="bsdf_samples" value="2"/>)"),
            40u);
  EXPECT_EQ(samples(R"(<integer name="emitter_samples" value="0"/><integer name="bsdf_samples" value="2"/>)"),
            20u);
}

}  // namespace
}  // namespace kiloband::test::test_emitters
