// Broken scenes, and scenes that name broken files, through the whole program: one of every kind. What else can be wrong, and
// what is said of it, is tested with the readers (tests/unit/scene, tests/unit/spectral).
#include <gtest/gtest.h>

#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test::test_scenes {
namespace {

/// A complete scene with a diffuse bsdf 'leaf' in line 2 that holds `parameter`.
std::string leaf(const std::string& parameter) {
  return complete_scene(R"xml(<bsdf type="diffuse" id="leaf">)xml" + parameter + "</bsdf>");
}

TEST(WrongScene, IsRefusedByRenderAndInfo) {
  const TemporaryFolder folder;
  folder.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  folder.write("truncated.hdr",
               "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + std::string(12, '\x80'));
  folder.write("word.spd", "400 0.1\n500 high\n");
  folder.write("reversed.csv", "min_nm,max_nm\n400,450\n500,450\n");
  folder.write("bad.xml", "<scene version=\"3.0.0\">\n<bsdf typ=\"x\"/>\n</scene>");
  const std::pair<std::string, std::string> cases[] = {
      {"", "broken.xml:1:1: error: no root element"},
      {"<scene version=\"3.0.0\">\n<shape type=\"sphere\">\n</scene>\n",
       "broken.xml:3:3: error: not well-formed XML: Start-end tags mismatch: <shape> of line 2 is not closed"},
      {leaf(R"xml(<spectrum name="reflectance" value="400:0.5, 550:1.27"/>)xml"),
       "broken.xml:2:68: error: bsdf 'leaf': reflectance 1.27 at 550 nm: must be in [0, 1]"},
      {complete_scene(kSensor + R"xml(<sensor type="batch"/>)xml"),
       "broken.xml:2:146: error: sensor type 'batch' is not supported: one camera a scene; -D can choose among "
       "several"},
      {complete_scene(R"xml(<shape type="obj"><string name="filename" value="index.obj"/></shape>)xml"),
       "broken.xml:2:50: error: ./index.obj:4: f: corner '4': position index 4: must be in 1..3, the "
       "number of such lines above"},
      {scene_text(
           R"xml(<emitter type="envmap"><string name="filename" value="truncated.hdr"/></emitter>)xml" +
           kSensor + kSphere),
       "broken.xml:2:55: error: ./truncated.hdr: cannot be read: the data of row 0 is damaged or truncated"},
      {leaf(R"xml(<spectrum name="reflectance" filename="word.spd"/>)xml"),
       "broken.xml:2:71: error: ./word.spd:2: 'high' is not a number"},
      {scene_text(
           R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands_file" value="reversed.csv"/></film></sensor>)xml" +
           kLight + kSphere),
       "broken.xml:2:83: error: ./reversed.csv:3: the interval is reversed: 500 nm is above 450 nm"},
      {complete_scene(R"xml(<include filename="bad.xml"/>)xml"),
       "./bad.xml:2:7: error: <bsdf>: unknown attribute 'typ'; did you mean 'type'?"},
  };
  for (const auto& [text, message] : cases) {
    folder.write("broken.xml", text);
    expect_refused(folder, {},
                   {
                       {{"info", "broken.xml"}, message},
                       {{"render", "broken.xml", "--quiet", "--spp", "1", "-o", "out.hdr", "-o", "out.exr",
                         "--stats", "s.json"},
                        message},
                   });
  }
}

}  // namespace
}  // namespace kiloband::test::test_scenes
