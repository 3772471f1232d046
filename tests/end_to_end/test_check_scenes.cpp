// kiloband info --check FOLDER.
#include <gtest/gtest.h>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

TEST(CheckScenes, SaysWhatStopsTheOthers) {
  const TemporaryFolder folder;
  folder.write("a/good.xml", complete_scene(""));
  folder.write("a/b/worse.xml", complete_scene(R"(<bsdf type="hair"/><bsdf type="difuse"/>)"));
  folder.write("hair.xml",
               "<?xml version=\"1.0\"?>\n<!-- <mesh> -->\n" + complete_scene(R"(<bsdf type="hair"/>)"));
  folder.write("other.xml", "<mesh/>");  // no scene
  folder.write("empty.xml", "");
  folder.write("typed.xml", "<!DOCTYPE scene [ <!ENTITY a \"b\"> ]>\n" + complete_scene(""));
  folder.write("html.xml", "<!DOCTYPE html>\n<html/>");  // no scene
  folder.write("wide.xml", std::string("\xFF\xFE<\0s\0c\0e\0n\0e\0/\0>\0", 18));
  folder.write("notes.txt", "<scene/>");
  const Outcome outcome = run_program(folder, {"info", "--check", "."});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(
      outcome.out,
      "stopped a/b/worse.xml\n"
      "  ./a/b/worse.xml:2:13: error: bsdf type 'hair' is not supported: there is no such model; 'roughdielectric' or 'principled' come near\n"
      "  ./a/b/worse.xml:2:32: error: bsdf type 'difuse' is not supported; did you mean 'diffuse'?\n"
      "loads   a/good.xml\n"
      "stopped empty.xml\n"
      "  ./empty.xml:1:1: error: no root element\n"
      "stopped hair.xml\n"
      "  ./hair.xml:4:13: error: bsdf type 'hair' is not supported: there is no such model; 'roughdielectric' or 'principled' come near\n"
      "stopped typed.xml\n"
      "  ./typed.xml:1:11: error: document type declarations are not supported\n"
      "stopped wide.xml\n"
      "  ./wide.xml:1:1: error: not valid UTF-8\n"
      "1 of 6 scenes load\n"
      "    2 stopped by: bsdf type 'hair' is not supported: there is no such model; 'roughdielectric' or 'principled' come near\n"
      "    1 stopped by: bsdf type 'difuse' is not supported\n"
      "    1 stopped by: document type declarations are not supported\n"
      "    1 stopped by: no root element\n"
      "    1 stopped by: not valid UTF-8\n");
}

/// Of every material there is a name.
TEST(SceneInfo, NamesEveryMaterial) {
  const TemporaryFolder folder;
  folder.write(
      "scene.xml",
      complete_scene(R"(<shape type="sphere"><bsdf type="principled" id="p"/></shape><shape type="cube"/>)"));
  const Outcome outcome = run_program(folder, {"info", "scene.xml"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("  principled       p\n"), std::string::npos) << outcome.out;
}

/// What only shows when a scene is made ready for rendering stops it too, and the options are those of the render.
TEST(CheckScenes, ScenesAreCompiledWithTheOptionsGiven) {
  const TemporaryFolder folder;
  folder.write(
      "palladium.xml",
      complete_scene(
          R"(<shape type="sphere"><bsdf type="conductor"><string name="metal" value="Pd"/></bsdf></shape>)"));
  const Outcome visible = run_program(folder, {"info", "--check", "."});
  EXPECT_EQ(visible.code, 0) << visible.out;
  EXPECT_EQ(visible.out, "loads   palladium.xml\n1 of 1 scenes load\n");
  const Outcome infrared = run_program(folder, {"info", "--check", ".", "--bands", "13000:14000:2"});
  EXPECT_EQ(infrared.code, 1);
  expect_text(infrared.out, "stopped palladium.xml\n");
  expect_text(infrared.out, "0 of 1 scenes load\n");
}

/// A link to itself is no scene, and stops nothing.
TEST(CheckScenes, LinksToThemselves) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  std::filesystem::create_symlink("loop.xml", folder / "loop.xml");
  const Outcome outcome = run_program(folder, {"info", "--check", "."});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "loads   scene.xml\n1 of 1 scenes load\n");
}

TEST(CheckScenes, FoldersWithoutScenes) {
  const TemporaryFolder folder;
  folder.write("other.xml", "<mesh/>");
  const Outcome none = run_program(folder, {"info", "--check", "."});
  EXPECT_EQ(none.code, 2);
  expect_text(none.err, ".: no scene file (*.xml with <scene>) below this folder");
  const Outcome file = run_program(folder, {"info", "--check", "other.xml"});
  EXPECT_EQ(file.code, 2);
  expect_text(file.err, "other.xml: is not a folder");
  EXPECT_EQ(run_program(folder, {"info", "--check", ".", "--materials"}).code, 2);
  const Outcome long_name = run_program(folder, {"info", "--check", std::string(300, 'x')});
  EXPECT_EQ(long_name.code, 2);
  expect_text(long_name.err, "x: is not a folder");
}

TEST(CheckScenes, AnEmptyNameIsNoFolder) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(folder, {"info", "--check", ""});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find(": is not a folder"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace kiloband::test
