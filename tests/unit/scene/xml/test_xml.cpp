// Includes, defaults, $names, references, old versions.
#include <gtest/gtest.h>

#include "tests/unit/scene/read/support.hpp"

namespace kiloband::test::test_xml {
namespace {

int width_of(const std::string& text, const std::filesystem::path& folder = "/nonexistent",
             const Defines& defines = {}) {
  return static_cast<int>(read(text, folder, defines).sensor.film.width);
}

const std::string kFilm =
    R"(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="$w"/></film></sensor>)";

TEST(SceneXml, DefaultsAreOverriddenByDefines) {
  const std::string text = scene(R"(<default name="w" value="17"/>)" + kFilm + kLight);
  EXPECT_EQ(width_of(text), 17);
  EXPECT_EQ(width_of(text, "/nonexistent", {{"w", "23"}}), 23);
  EXPECT_EQ(width_of(scene(kFilm + kLight), "/nonexistent", {{"w", "23"}}), 23);
}

TEST(SceneXml, FirstDefaultWinsAndDefaultsMayUseDefaults) {
  EXPECT_EQ(error_of(complete_scene(R"(<default name="a" value="1"/><default name="a" value="2"/>)"
                                    R"(<default name="w" value="$a\$"/><bsdf type="$w"/>)")),
            "scene.xml:2:103: error: bsdf type '1$' is not supported");
  EXPECT_EQ(
      width_of(scene(R"(<default name="a" value="1"/><default name="w" value="$a$a"/>)" + kFilm + kLight)),
      11);
}

TEST(SceneXml, IncludesAreSplicedAndSharePathsOfTheMainScene) {
  const TemporaryFolder folder;
  folder.write("parts/film.xml",
               scene(R"(<default name="w" value="31"/><include filename="parts/sensor.xml"/>)"));
  folder.write("parts/sensor.xml", kFilm);
  const auto main = folder.write("main.xml", scene(R"(<include filename="parts/film.xml"/>)" + kLight));
  const SceneDescription result = read_scene(main);
  EXPECT_EQ(result.sensor.film.width, 31u);
  EXPECT_EQ(result.file, main);
}

TEST(SceneXml, PathAddsSearchFolders) {
  const TemporaryFolder folder;
  folder.write("extra/film.xml", scene(kFilm));
  const std::string text =
      scene(R"(<default name="w" value="5"/><path value="extra"/><include filename="film.xml"/>)" + kLight);
  EXPECT_EQ(width_of(text, folder.path()), 5);
}

TEST(SceneXml, ForwardReferencesAndAliases) {
  const SceneDescription result = read(complete_scene(
      R"(<alias id="second" as="third"/><alias id="first" as="second"/>)"
      R"(<shape type="disk"><ref id="third"/></shape><shape type="disk"><ref id="first" name="bsdf"/></shape>)"
      R"(<bsdf type="plastic" id="first"/>)"));
  ASSERT_EQ(result.shapes.size(), 3u);
  EXPECT_EQ(result.shapes[0].bsdf, result.shapes[1].bsdf);
  EXPECT_EQ(result.shapes[0].bsdf->id, "first");
  EXPECT_TRUE(std::holds_alternative<PlasticBsdf>(result.shapes[0].bsdf->model));
  EXPECT_EQ(result.shapes[0].bsdf->position.to_string(), "scene.xml:2:164");
}

TEST(SceneXml, EntitiesAreDecodedAndPositionsStayExact) {
  EXPECT_EQ(
      error_of(scene("<!-- \xC3\xA4 -->\n  <bsdf id=\"&#65;&lt;&quot;&#x42;&apos;&gt;&amp;\" type='x'/>")),
      "scene.xml:3:57: error: bsdf type 'x' is not supported");
  EXPECT_EQ(error_of(complete_scene(
                "<bsdf id=\"&#65;&#x20AC;\" type='diffuse'><float name='alpha' value='1'/></bsdf>")),
            "scene.xml:2:54: error: bsdf 'A\xE2\x82\xAC': unknown parameter 'alpha'");
}

TEST(SceneXml, ByteOrderMarkCountsAsBytes) {
  EXPECT_EQ(error_of("\xEF\xBB\xBF<scene/>"),
            "scene.xml:1:5: error: <scene>: attribute 'version' is missing");
}

TEST(SceneXml, OldVersionsHaveCamelCaseAndLookAt) {
  const std::string body =
      R"(<sensor type="perspective"><float name="nearClip" value="3"/><transform name="toWorld">)"
      R"(<lookAt origin="1,2,3" target="1,2,4" up="0,1,0"/></transform></sensor>)" +
      kLight;
  const SceneDescription result = read("<scene version=\"0.6.0\">" + body + "</scene>");
  EXPECT_EQ(result.sensor.near_clip, 3);
  EXPECT_EQ(result.sensor.to_world[3], glm::dvec4(1, 2, 3, 1));
  EXPECT_EQ(error_of("<scene version=\"2.0.0\">" + body + "</scene>"),
            "scene.xml:1:112: error: unknown element <lookAt>; did you mean 'lookat'?");
}

TEST(SceneXml, ObsoleteParametersOfOldFilesAreReported) {
  Messages messages;
  const std::string body =
      R"(<sensor type="perspective"><sampler type="ldsampler"><integer name="dimension" value="4"/></sampler>
<film type="hdrfilm"><boolean name="banner" value="false"/><boolean name="attachLog" value="true"/></film></sensor>)";
  read("<scene version=\"0.5\">\n" + body + kLight + "</scene>", "/nonexistent", {}, messages.lines());
  ASSERT_EQ(messages.texts.size(), 4u);
  EXPECT_EQ(messages.texts[0],
            "scene.xml:3:37: warning: hdrfilm film: parameter 'banner' of old files has no meaning here");
  EXPECT_EQ(messages.texts[1],
            "scene.xml:3:75: warning: hdrfilm film: parameter 'attach_log' of old files has no meaning here");
  EXPECT_EQ(
      messages.texts[2],
      "scene.xml:2:69: warning: ldsampler sampler: parameter 'dimension' of old files has no meaning here");
  EXPECT_EQ(messages.texts[3],
            "scene.xml:2:43: note: sampler type 'ldsampler' is replaced by the program's own (--sampler)");
  EXPECT_EQ(
      error_of(scene(R"(<sensor type="perspective"><float name="nearClip" value="3"/></sensor>)")),
      "scene.xml:2:41: error: perspective sensor: unknown parameter 'nearClip'; did you mean 'near_clip'?");
  EXPECT_EQ(error_of(scene(body)),
            "scene.xml:2:69: error: ldsampler sampler: unknown parameter 'dimension'\n"
            "scene.xml:3:37: error: hdrfilm film: unknown parameter 'banner'\n"
            "scene.xml:3:75: error: hdrfilm film: unknown parameter 'attachLog'");
}

TEST(SceneXml, DefinesMustBeKnown) {
  const std::string text = complete_scene(R"(<default name="spp" value="4"/>)");
  EXPECT_EQ(error_of(text, "/nonexistent", {{"sppp", "8"}}),
            "scene.xml: error: -D sppp=8: the scene has no parameter '$sppp'; did you mean 'spp'?");
  EXPECT_EQ(error_of(text, "/nonexistent", {{"5", "8"}}), "-D 5=8: '5' is not a parameter name");
  EXPECT_EQ(error_of(text, "/nonexistent", {{"spp", "8"}}), "accepted");
}

TEST(SceneXml, MissingSceneFile) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "none.xml").string();
  EXPECT_EQ(error_of([&] { read_scene(file); }), file + ": error: file not found");
}

TEST(SceneXml, IncludesThatMultiplyAreStopped) {
  const TemporaryFolder folder;
  for (int i = 0; i < 40; ++i) {
    const std::string next = R"(<include filename="f)" + std::to_string(i + 1) + R"(.xml"/>)";
    folder.write("f" + std::to_string(i) + ".xml", scene(next + next));
  }
  folder.write("f40.xml", scene(""));
  EXPECT_EQ(error_of(complete_scene(R"(<include filename="f0.xml"/>)"), folder),
            "f39.xml:2:49: error: more than 1000 includes");
}

TEST(SceneXml, UnusedAreaEmitterIsReported) {
  Messages messages;
  read(complete_scene(R"(<emitter type="area" id="lamp"/>)"), "/nonexistent", {}, messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "scene.xml:2:2: warning: emitter 'lamp': is not part of a shape and has no effect");
}

}  // namespace
}  // namespace kiloband::test::test_xml
