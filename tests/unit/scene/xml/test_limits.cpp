// What a scene file could multiply without end: files in files,
// elements of every kind, attributes, references.
#include <gtest/gtest.h>

#include "scene/xml/document.hpp"
#include "tests/unit/scene/read/support.hpp"

namespace kiloband::test::test_limits {
namespace {

std::string repeated(const std::string& text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

/// The message of parsing `text` as a further file of a scene.
std::string parse_error(const std::string& text, XmlTotals totals) {
  const std::string name = "part.xml";
  return error_of([&] { parse_xml(text, &name, totals); });
}

TEST(SceneLimits, ElementsOfAllFilesCount) {
  const std::string text = "<scene><!-- <a/> --><?b?>\n<default/></scene>";
  EXPECT_EQ(parse_error(text, {kMaxElements - 2, 0}), "accepted");
  EXPECT_EQ(parse_error(text, {kMaxElements - 1, 0}),
            "part.xml:2:2: error: more than 2000000 elements, those of included files counted each time");
}

TEST(SceneLimits, DirectivesOfIncludedFilesCount) {
  const TemporaryFolder folder;
  folder.write("d.xml", scene(repeated(R"(<default name="a" value=""/>)", 700000)));
  EXPECT_EQ(error_of(complete_scene(repeated(R"(<include filename="d.xml"/>)", 3)), folder),
            "d.xml:2:16799722: error: more than 2000000 elements, those of included files counted each time");
}

TEST(SceneLimits, BytesOfAllFilesCount) {
  const std::string text = "<scene/>";
  EXPECT_EQ(parse_error(text, {0, kMaxSceneBytes - text.size()}), "accepted");
  EXPECT_EQ(parse_error(text, {0, kMaxSceneBytes - text.size() + 1}),
            "part.xml:1:1: error: the files of the scene are larger than 1 GiB together");
}

TEST(SceneLimits, AttributesOfAnElement) {
  std::string element = "<sensor";
  for (int i = 0; i < 17; ++i) element += " a" + std::to_string(i) + "=\"\"";
  EXPECT_EQ(error_of(scene(element + "/>")), "scene.xml:2:111: error: <sensor>: more than 16 attributes");
}

TEST(SceneLimits, SearchFolders) {
  const TemporaryFolder folder;
  const std::string path = R"(<path value="."/>)";
  EXPECT_EQ(error_of(complete_scene(repeated(path, 100)), folder), "accepted");
  EXPECT_EQ(error_of(complete_scene(repeated(path, 101)), folder),
            "scene.xml:2:1702: error: more than 100 folders");
}

TEST(SceneLimits, WhatManyObjectsReferToIsReadOnce) {
  const std::string spectrum =
      R"(<spectrum type="irregular" id="s"><string name="wavelengths" value="400 500"/><string name="values" value="0 1"/></spectrum>)";
  const std::string sphere =
      R"(<shape type="sphere"><bsdf type="diffuse"><ref name="reflectance" id="s"/></bsdf></shape>)";
  const SceneDescription result = read(complete_scene(spectrum + sphere + sphere));
  const auto reflectance = [&](std::size_t shape) {
    return std::get<Spectrum>(std::get<DiffuseBsdf>(result.shapes.at(shape).bsdf->model).reflectance);
  };
  EXPECT_EQ(&reflectance(0).node(), &reflectance(1).node());
}

TEST(SceneLimits, ShapesAndLightsStandInTheSceneOnce) {
  EXPECT_EQ(error_of(complete_scene(R"(<shape type="disk" id="a"/><ref id="a"/>)")),
            "scene.xml:2:29: error: scene: shape 'a' is in the scene already");
  EXPECT_EQ(error_of(complete_scene(R"(<ref id="a"/><emitter type="point" id="a"/>)")),
            "scene.xml:2:15: error: scene: emitter 'a' is in the scene already");
  EXPECT_EQ(error_of(complete_scene(R"(<bsdf type="diffuse" id="a"/><ref id="a"/>)")), "accepted");
}

}  // namespace
}  // namespace kiloband::test::test_limits
