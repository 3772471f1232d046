// Transforms and plain values.
#include <gtest/gtest.h>

#include <numbers>

#include "scene/read/object/object.hpp"
#include "scene/xml/values.hpp"
#include "support.hpp"

namespace kiloband::test::test_values {
namespace {

Transform transform_of(const std::string& steps) {
  return read(scene(R"(<shape type="rectangle"><transform name="to_world">)" + steps +
                    "</transform></shape>" + kSensor + kLight))
      .shapes.at(0)
      .to_world;
}

std::string textured_scene(const std::string& steps) {
  return scene(
      R"(<shape type="rectangle"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"><transform name="to_uv">)" +
      steps + "</transform></texture></bsdf></shape>" + kSensor + kLight);
}

glm::dmat3 uv_transform_of(const std::string& steps, const DiagnosticSink& sink = {}) {
  const SceneDescription result = read(textured_scene(steps), "/nonexistent", {}, sink);
  const auto& diffuse = std::get<DiffuseBsdf>(result.shapes.at(0).bsdf->model);
  return std::get<std::shared_ptr<const CheckerboardTexture>>(diffuse.reflectance)->to_uv;
}

void expect_point(const Transform& m, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 got(m * glm::dvec4(from, 1));
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(got[axis], to[axis], 1e-12);
}

TEST(SceneTransform, StepsActInTheirOrder) {
  expect_point(transform_of(R"(<translate x="1"/><scale value="2"/>)"), {0, 0, 0}, {2, 0, 0});
  expect_point(transform_of(R"(<scale x="2" z="3"/><translate value="1, 1, 1"/>)"), {1, 1, 1}, {3, 2, 4});
  expect_point(transform_of(R"(<scale x="2" z="3"/><translate value="1"/>)"), {1, 1, 1}, {3, 2, 4});
  expect_point(transform_of(R"(<rotate value="5" angle="120"/>)"), {1, 2, 3}, {3, 1, 2});
}

TEST(SceneTransform, RotationIsCounterClockwise) {
  expect_point(transform_of(R"(<rotate z="1" angle="90"/>)"), {1, 0, 0}, {0, 1, 0});
  expect_point(transform_of(R"(<rotate x="2" angle="90"/>)"), {0, 1, 0}, {0, 0, 1});
}

TEST(SceneTransform, MatricesAreRowMajor) {
  expect_point(transform_of(R"(<matrix value="1 2 0 5, 0 1 0 6, 0 0 1 7, 0 0 0 1"/>)"), {1, 1, 1}, {8, 7, 8});
  expect_point(transform_of(R"(<matrix value="0 1 0 1 0 0 0 0 2"/>)"), {3, 4, 5}, {4, 3, 10});
}

TEST(SceneTransform, LookatLooksAlongZWithXToTheLeft) {
  const Transform m = transform_of(R"(<lookat origin="0 0 5" target="0 0 0" up="0 3 0"/>)");
  expect_point(m, {0, 0, 1}, {0, 0, 4});
  expect_point(m, {0, 1, 0}, {0, 1, 5});
  expect_point(m, {1, 0, 0}, {-1, 0, 5});  // looking along -z with +y up, left is -x
  const Transform without_up = transform_of(R"(<lookat origin="0 0 0" target="0 2 0"/>)");
  EXPECT_NEAR(glm::determinant(glm::dmat3(without_up)), 1, 1e-12);
  expect_point(without_up, {0, 0, 1}, {0, 1, 0});
}

TEST(SceneTransform, TextureTransformsAreTwoDimensional) {
  const glm::dmat3 m = uv_transform_of(R"(<scale x="8" y="4"/><translate x="0.5"/>)");
  EXPECT_EQ(m * glm::dvec3(1, 1, 1), glm::dvec3(8.5, 4, 1));
  EXPECT_EQ(uv_transform_of(R"(<matrix value="1 2 3 4 5 6 0 0 1"/>)") * glm::dvec3(1, 1, 1),
            glm::dvec3(6, 15, 1));
}

/// Rows of [2][3]: u and v of Mitsuba 3.9.1 as affine functions of (u, v, 1), measured on a bitmap of ramps.
void expect_uv(const std::string& steps, const std::vector<double>& expected) {
  const glm::dmat3 m = uv_transform_of(steps);
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(m[i % 3][i / 3], expected[static_cast<std::size_t>(i)], 1e-12) << steps << " entry " << i;
}

TEST(SceneTransform, TextureMatricesOfSixteenNumbersActAsInMitsuba) {
  const std::string matrix = R"(<matrix value=".7 .1 0 .02, .2 .8 0 .04, 0 0 1 0, 0 0 0 1"/>)";
  const std::string scale = R"(<scale x=".5" y=".8"/>)", translate = R"(<translate x=".1" y=".2"/>)";
  expect_uv(matrix, {.7, .1, .02, .2, .8, .04});
  expect_uv(matrix + scale, {.35, .05, .01, .16, .64, .032});
  expect_uv(scale + matrix, {.35, .08, .02, .1, .64, .04});
  expect_uv(translate + matrix, {.7, .1, .11, .2, .8, .22});
  expect_uv(matrix + translate, {.7, .1, .12, .2, .8, .24});
  expect_uv(R"(<matrix value="10 0 0 0, 0 10 0 0, 0 0 1 0, 0 0 0 1"/>)", {10, 0, 0, 0, 10, 0});
}

TEST(SceneTransform, TexturesHaveNoThirdCoordinate) {
  Messages messages;
  const std::string warning =
      "warning: a texture has no third coordinate: of the matrix only the first two rows count, without "
      "their "
      "third column (translations stand in the fourth)";
  const glm::dmat3 m =
      uv_transform_of(R"(<matrix value=".7 .1 .5 0, .2 .8 .6 0, 0 0 1 0, 0 0 0 1"/>)", messages.lines());
  EXPECT_EQ(m * glm::dvec3(1, 1, 1), glm::dvec3(.7 + .1, .2 + .8, 1));
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0], "scene.xml:2:133: " + warning);
  uv_transform_of(R"(<matrix value="1 0 0 0, 0 1 0 0, 0 .5 1 0, 0 0 0 1"/>)", messages.lines());
  ASSERT_EQ(messages.texts.size(), 2u);
  EXPECT_EQ(messages.texts[1], "scene.xml:2:133: " + warning);
  uv_transform_of(R"(<matrix value="1 0 .5 0 1 0 0 0 1"/>)", messages.lines());
  ASSERT_EQ(messages.texts.size(), 3u);
  EXPECT_EQ(messages.texts[2],
            "scene.xml:2:133: note: a texture transform's <matrix> of 9 numbers: its third column is the "
            "translation, which Mitsuba 3 ignores (16 numbers mean the same to both)");
  uv_transform_of(
      R"(<matrix value="4 0 0 0 4 0 0 0 1"/><matrix value="2 0 0 1, 0 1 0 2, 0 0 3 0, 0 0 0 1"/>)",
      messages.lines());
  EXPECT_EQ(messages.texts.size(), 3u);
}

TEST(SceneTransform, OldTexturesHaveScalesAndOffsets) {
  const auto old_scene = [](const std::string& parameters) {
    return R"(<scene version="0.6.0"><shape type="disk"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance">)" +
           parameters + "</texture></bsdf></shape>" + kSensor + kLight + "</scene>";
  };
  const std::string scale = R"(<float name="uscale" value="2"/>)";
  const SceneDescription result =
      read(old_scene(scale + R"(<float name="vscale" value="3"/><float name="uoffset" value="0.5"/>)"));
  const auto& diffuse = std::get<DiffuseBsdf>(result.shapes.at(0).bsdf->model);
  const glm::dmat3 m = std::get<std::shared_ptr<const CheckerboardTexture>>(diffuse.reflectance)->to_uv;
  EXPECT_EQ(m * glm::dvec3(1, 1, 1), glm::dvec3(3, 3, 1));
  EXPECT_EQ(error_of(old_scene(scale + R"(<transform name="toUV"><scale x="2"/></transform>)")),
            "scene.xml:1:140: error: checkerboard texture: uscale together with to_uv");
}

TEST(SceneTransform, WrongTextureMatrices) {
  const std::string at = "scene.xml:2:133: error: ";
  EXPECT_EQ(error_of(textured_scene(R"(<matrix value="1 0 0 0, 0 1 0 0, 0 0 1 0, 0 0 0 2"/>)")),
            at + "the last row of the matrix must be 0 0 0 1");
  EXPECT_EQ(error_of(textured_scene(R"(<matrix value="1 0 0 0 1 0 0 1 1"/>)")),
            at + "the last row of the matrix must be 0 0 1");
  EXPECT_EQ(error_of(textured_scene(R"(<matrix value="1 0 0 0 1 0"/>)")),
            at + "<matrix> needs 16 or 9 numbers, found 6");
  EXPECT_EQ(error_of(textured_scene(R"(<matrix value="1 2 0 0, 2 4 0 0, 0 0 1 0, 0 0 0 1"/>)")),
            "scene.xml:2:95: error: transform 'to_uv' is singular");
  EXPECT_EQ(error_of(textured_scene(R"(<rotate y="1" angle="10"/>)")),
            "scene.xml:2:119: error: <rotate> leaves the plane of the texture");
}

TEST(SceneValues, IntegersServeAsFloatsAndBooleansIgnoreCase) {
  const SceneDescription result =
      read(scene(R"(<sensor type="perspective"><integer name="near_clip" value="+2"/>)"
                 R"(<float name="far_clip" value=" 3e1 "/></sensor>)"
                 R"(<shape type="sphere"><boolean name="flip_normals" value="True"/></shape>)" +
                 kLight));
  EXPECT_EQ(result.sensor.near_clip, 2);
  EXPECT_EQ(result.sensor.far_clip, 30);
  EXPECT_TRUE(result.shapes.at(0).flip_normals);
}

TEST(SceneValues, NumbersRoundTrip) {
  const Place place;
  for (const double value : {0.1, 1e-300, 12345.678, -3.0})
    EXPECT_EQ(parse_number(format_number(value), place), value);
  EXPECT_THROW(parse_number("+-1", place), InputError);
  EXPECT_THROW(parse_number("1e999", place), InputError);
  EXPECT_THROW(parse_number("", place), InputError);
  EXPECT_THROW(parse_integer("9223372036854775808", place), InputError);
}

TEST(SceneValues, SuggestionsAreNear) {
  EXPECT_EQ(suggestion("reflectence", {"alpha", "reflectance"}), "; did you mean 'reflectance'?");
  EXPECT_EQ(suggestion("banana", {"alpha", "reflectance"}), "");
  EXPECT_EQ(suggestion("bsfd", {"bsdf"}), "; did you mean 'bsdf'?");
  EXPECT_EQ(suggestion("a", {"b"}), "");
  EXPECT_EQ(suggestion("", {"a"}), "");
}

TEST(SceneValues, SnakeCase) {
  EXPECT_EQ(snake_case("toWorld"), "to_world");
  EXPECT_EQ(snake_case("intIOR"), "int_ior");
  EXPECT_EQ(snake_case("reflectance"), "reflectance");
  EXPECT_EQ(snake_case("crop_width"), "crop_width");
}

}  // namespace
}  // namespace kiloband::test::test_values
