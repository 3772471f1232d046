// What scenes of Mitsuba 3 often have and what means something else here, or nothing.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_common_scenes {
namespace {

struct Reading {
  SceneDescription scene;
  std::vector<std::string> told;
};

Reading reading(const std::string& text) {
  Messages messages;
  Reading result{read(text, "/nonexistent", {}, messages.lines()), {}};
  result.told = messages.texts;
  return result;
}

TEST(CommonScenes, OfSeveralSensorsTheFirstIsRendered) {
  const std::string second =
      R"(<sensor type="orthographic"><sampler type="independent"><integer name="sample_count" value="9"/></sampler></sensor>)";
  const Reading two = reading(scene(kSensor + second + second + kLight + kSphere));
  EXPECT_TRUE(std::holds_alternative<PerspectiveSensor>(two.scene.sensor.model));
  EXPECT_EQ(two.scene.sensor.sample_count, 4u);
  ASSERT_EQ(two.told.size(), 1u);
  EXPECT_EQ(two.told[0], "scene.xml:2:30: warning: scene: a second sensor: the first is rendered");
}

TEST(CommonScenes, IntegratorsForDerivativesAreAPath) {
  const Reading prb =
      reading(complete_scene(R"(<integrator type="prb"><integer name="max_depth" value="7"/></integrator>)"));
  EXPECT_EQ(prb.scene.integrator.max_depth, 7);
  ASSERT_EQ(prb.told.size(), 1u);
  EXPECT_EQ(
      prb.told[0],
      "scene.xml:2:19: note: prb integrator: nothing is differentiated: rendered as 'path', which has the same image");
}

TEST(CommonScenes, SchedulingHasNoMeaning) {
  const Reading path = reading(complete_scene(
      R"(<integrator type="path"><integer name="samples_per_pass" value="16"/><integer name="block_size" value="32"/><float name="timeout" value="60"/></integrator>)"));
  ASSERT_EQ(path.told.size(), 1u);
  EXPECT_EQ(path.told[0],
            "scene.xml:2:138: note: path integrator: 'timeout' has no meaning here: use --time");
}

TEST(CommonScenes, AnAovIntegratorMayStandAlone) {
  const Reading aov =
      reading(complete_scene(R"(<integrator type="aov"><string name="aovs" value="d:depth"/></integrator>)"));
  EXPECT_EQ(aov.scene.requested.auxiliary, std::vector<std::string>{"depth"});
  ASSERT_EQ(aov.told.size(), 1u);
  EXPECT_EQ(
      aov.told[0],
      "scene.xml:2:19: note: aov integrator: has no nested integrator: there is the image of 'path', too");
}

TEST(CommonScenes, RadianceMetersAreCamerasOfOneRay) {
  const std::string film =
      R"(<film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>)";
  const Reading meter = reading(scene(
      R"(<sensor type="radiancemeter"><point name="origin" value="1, 2, 3"/><vector name="direction" value="0, 0, -2"/>)" +
      film + "</sensor>" + kLight));
  const Sensor& sensor = meter.scene.sensor;
  EXPECT_EQ(std::get<PerspectiveSensor>(sensor.model).fov_x, 0);
  EXPECT_EQ(glm::dvec3(sensor.to_world[2]), glm::dvec3(0, 0, -1));
  EXPECT_EQ(glm::dvec3(sensor.to_world[3]), glm::dvec3(1, 2, 3));
  EXPECT_NEAR(glm::determinant(glm::dmat3(sensor.to_world)), 1, 1e-12);
  EXPECT_LT(sensor.near_clip, 1e-6) << "it has no lens in front";
  const auto clipped = read(scene(R"(<sensor type="radiancemeter"><float name="near_clip" value="2"/>)" +
                                  film + "</sensor>" + kLight));
  EXPECT_EQ(clipped.sensor.near_clip, 2);
  expect_messages(
      {{"film", scene(R"(<sensor type="radiancemeter"/>)" + kLight),
        "scene.xml:2:2: error: radiancemeter sensor: its film must be of one pixel, found 768 x 576"},
       {"no direction",
        scene(R"(<sensor type="radiancemeter"><vector name="direction" value="0, 0, 0"/>)" + film +
              "</sensor>" + kLight),
        "scene.xml:2:62: error: radiancemeter sensor: direction: its length must be > 0"}});
}

TEST(CommonScenes, MergedShapesAreShapesOfTheirOwn) {
  const std::string merge =
      R"(<shape type="merge"><shape type="cube" id="a"/><shape type="rectangle" id="b"/></shape>)";
  const SceneDescription scene = read(test::scene(merge + kSensor + kLight));
  ASSERT_EQ(scene.shapes.size(), 2u);
  EXPECT_EQ(scene.shapes[0].id, "a");
  EXPECT_EQ(scene.shapes[1].id, "b");
  const SceneDescription grouped =
      read(test::scene(R"(<shape type="shapegroup" id="g">)" + merge +
                       R"(</shape><shape type="instance"><ref id="g"/></shape>)" + kSensor + kLight));
  EXPECT_EQ(grouped.instances.at(0).group->shapes.size(), 2u);
  expect_messages({{"empty", complete_scene(R"(<shape type="merge"/>)"),
                    "scene.xml:2:2: error: merge shape: has no shapes"},
                   {"nested", complete_scene(R"(<shape type="merge"><shape type="merge"/></shape>)"),
                    "scene.xml:2:22: error: merge shape: shapes of type merge cannot be merged"}});
}

TEST(CommonScenes, MediaWithoutAlbedoAbsorb) {
  const SceneDescription scene = read(complete_scene(
      R"(<shape type="sphere"><bsdf type="null"/><medium type="homogeneous" name="interior"><spectrum name="albedo" value="0"/><spectrum name="sigma_t" value="400:1, 700:3"/><float name="scale" value="2"/><phase type="hg"><float name="g" value="0.5"/></phase></medium></shape>)"));
  const Medium& medium = *scene.shapes.at(0).interior;
  EXPECT_EQ(medium.absorption(550), 2);
  EXPECT_EQ(medium.scale, 2);
  EXPECT_FALSE(medium.temperature_k);
}

std::string metal(const std::string& alpha) {
  return complete_scene(R"(<bsdf type="roughconductor" id="m">)" + alpha +
                        R"(</bsdf><shape type="cube"><ref id="m"/></shape>)");
}

// As a bitmap of 2 x 2 texels. In Mitsuba 3.9.1 the numbers of a checkerboard stand where the other has its colour.
TEST(CommonScenes, CheckerboardsOfNumbersServeAsNumbers) {
  const std::string board =
      R"( type="checkerboard"><float name="color0" value="0.1"/><float name="color1" value="0.4"/><transform name="to_uv"><scale x="3"/></transform></texture>)";
  const SceneDescription scene = read(metal(R"(<texture name="alpha")" + board));
  const auto& bsdf = std::get<ConductorBsdf>(scene.shapes.at(0).bsdf->model);
  ASSERT_TRUE(bsdf.roughness && bsdf.roughness->map_u);
  EXPECT_EQ(bsdf.roughness->map_u->image->pixels, (std::vector<float>{0.4F, 0.1F, 0.1F, 0.4F}));
  EXPECT_TRUE(bsdf.roughness->map_u->nearest && bsdf.roughness->map_u->raw);
  EXPECT_EQ(bsdf.roughness->map_u->to_uv[0][0], 3);
  const SceneDescription mask = read(
      complete_scene(R"(<shape type="cube"><bsdf type="mask"><bsdf type="diffuse"/><texture name="opacity")" +
                     board + "</bsdf></shape>"));
  EXPECT_TRUE(std::holds_alternative<std::shared_ptr<const BitmapTexture>>(
      std::get<MaskBsdf>(mask.shapes.at(0).bsdf->model).opacity));
  EXPECT_EQ(
      error_of(metal(
          R"(<texture name="alpha" type="checkerboard"><spectrum name="color0" value="400:0.1, 700:0.2"/></texture>)")),
      "scene.xml:2:64: error: bsdf 'm': alpha: only a number, a bitmap or a checkerboard of numbers is supported here");
}

TEST(CommonScenes, CheckerboardsOnLampsMayBeBright) {
  const std::string board = R"( type="checkerboard"><spectrum name="color0" value="10"/></texture>)";
  const SceneDescription scene = read(complete_scene(
      R"(<shape type="cube"><emitter type="area"><texture name="radiance")" + board + "</emitter></shape>"));
  const auto& texture =
      std::get<std::shared_ptr<const CheckerboardTexture>>(scene.shapes.at(0).emitter->radiance);
  EXPECT_EQ(texture->color0(550), 10);
  EXPECT_EQ(
      error_of(complete_scene(R"(<bsdf type="diffuse"><texture name="reflectance")" + board + "</bsdf>")),
      "scene.xml:2:56: error: diffuse bsdf: reflectance: color0 10: must be in [0, 1]");
}

TEST(CommonScenes, SensorsInShapesAreRefused) {
  expect_messages(
      {{"irradiancemeter", complete_scene(R"(<shape type="cube"><sensor type="irradiancemeter"/></shape>)"),
        "scene.xml:2:34: error: sensor type 'irradiancemeter' is not supported: only cameras with a film; radiance of "
        "an even surface with a 'diffuse' of reflectance 1 is its irradiance over pi"}});
}

TEST(CommonScenes, ParametersOfOtherPurposeAreAccepted) {
  for (
      const char* text :
      {R"(<shape type="cube"><float name="silhouette_sampling_weight" value="2"/></shape>)",
       R"(<bsdf type="diffuse"><texture type="rawconstant" name="reflectance"><float name="value" value="0.3"/></texture></bsdf>)",
       R"(<bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="null"/></bsdf>)"})
    EXPECT_EQ(error_of(complete_scene(text)), "accepted") << text;
  EXPECT_EQ(
      error_of(scene(
          R"(<sensor type="perspective"><film type="hdrfilm"><boolean name="compensate" value="true"/></film><sampler type="orthogonal"><integer name="strength" value="2"/></sampler></sensor>)" +
          kLight + kSphere)),
      "accepted");
  EXPECT_EQ(
      error_of(scene(R"(<sensor type="perspective"><spectrum name="srf" value="1"/></sensor>)" + kLight +
                     kSphere)),
      "scene.xml:2:56: error: perspective sensor: srf: channels have no response here: name it in a specfilm, or give it to --response");
}

}  // namespace
}  // namespace kiloband::test::test_common_scenes
