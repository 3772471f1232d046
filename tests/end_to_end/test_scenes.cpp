// The generated scenes: the same bytes in every run and on every machine,
// and read and rendered by the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include "base/hash.hpp"
#include "scenes/generator/scenes.hpp"
#include "tests/end_to_end/support/program.hpp"
#include "tests/unit/scenes/mesh_checks.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;

/// FNV-1a, 64 bits, over names and contents of all files in meshes/ and textures/, sorted by name.
std::string hash_of(const fs::path& scene) {
  std::set<fs::path> files;
  for (const char* part : {"meshes", "textures"}) {
    for (const auto& entry : fs::directory_iterator(scene / part)) files.insert(entry.path());
  }
  uint64_t hash = kFnvBasis<uint64_t>;
  for (const fs::path& file : files)
    hash = fnv1a(read_file(file), fnv1a(file.filename().string() + '\n', hash));
  std::ostringstream text;
  text << std::hex << hash;
  return text.str();
}

/// Runs generate_scenes in the folder; standard output and error together are in its file "log".
int generate(const TemporaryFolder& folder, const std::string& arguments) {
  const std::string command =
      "cd '" + folder.path().string() + "' && '" KILOBAND_GENERATE_SCENES "' " + arguments + " > log 2>&1";
  return WEXITSTATUS(std::system(command.c_str()));
}

/// The number in parentheses after "shapes" in what `kiloband info` prints; and that after "bsdfs".
std::size_t number_after(const std::string& text, const std::string& label) {
  const auto at = text.find(label);
  return at == std::string::npos
             ? 0
             : std::stoul(text.substr(text.find_first_of("0123456789", at + label.size())));
}

/// `hash` was computed once: it is to be the same for every compiler, processor and C library. After a change
/// of the generator that means to change the scene, take the one that the failure prints.
void expect_scene(const TemporaryFolder& folder, const std::string& name, const std::string& hash,
                  std::size_t triangles, std::size_t materials, int max_depth) {
  EXPECT_EQ(hash_of(folder / "out" / name), hash);

  const std::string scene = "out/" + name + "/" + name + ".xml";
  const Outcome info = run_program(folder, {"info", scene});
  ASSERT_EQ(info.code, 0) << info.err;
  EXPECT_EQ(info.err, "") << "notes or warnings";
  EXPECT_GE(number_after(info.out, " ("), triangles);
  EXPECT_GE(number_after(info.out, "\nbsdfs"), materials);
  EXPECT_NE(info.out.find("max_depth " + std::to_string(max_depth) + ","), std::string::npos) << info.out;

  const Outcome render =
      run_program(folder, quiet_render(scene, {"--size", "32x18", "--spp", "4", "--bands", "400:700:8", "-o",
                                               "a.hdr", "--stats", "a.json"}));
  ASSERT_EQ(render.code, 0) << render.err;
  EXPECT_EQ(read_json(folder, "a.json")["invalid_samples"], 0);
  std::size_t lit = 0;
  for (const float value : read_cube(folder / "a.hdr").mean) lit += value > 0;
  EXPECT_GT(lit, 32u * 18 * 8 * 99 / 100) << "some pixels are black";
}

/// The same of what the program writes into a folder "out".
void expect_generated_scene(const std::string& name, const std::string& hash, std::size_t triangles,
                            std::size_t materials, int max_depth) {
  const TemporaryFolder folder;
  ASSERT_EQ(generate(folder, "out " + name), 0) << folder.read("log");
  expect_scene(folder, name, hash, triangles, materials, max_depth);
}

TEST(GeneratedScenes, Conference) {
  expect_generated_scene("conference", "25e736e90cce713f", 200000, 15, 9);
}

/// As the program makes and writes it. Computed once for its files and for its meshes, part by part (tests/unit/scenes has the other
/// scenes').
TEST(GeneratedScenes, Statues) {
  const auto& known = generator::known_scenes();
  const auto found = std::ranges::find(known, "statues", &generator::KnownScene::name);
  ASSERT_NE(found, known.end());
  const generator::Scene scene = found->make();
  const TemporaryFolder folder;
  generator::write_scene(scene, KILOBAND_SOURCE_DIR "/scenes", folder / "out");
  expect_scene(folder, "statues", "286e7780aa9f4b9f", 300000, 8, 17);
  check_parts(scene);
  std::size_t sculptures = 0;
  for (const char* name : {"bust", "veiled_figure", "gyroid_ball", "glass_knot", "twisted_column"}) {
    sculptures += scene.parts.at(name).triangles.size();
  }
  EXPECT_GT(sculptures, 300000u);
  // What light goes through must bound a volume without any doubt.
  EXPECT_TRUE(is_manifold(generator::in_single_precision(scene.parts.at("glass_knot"))));
  EXPECT_TRUE(is_manifold(generator::in_single_precision(scene.parts.at("veiled_figure"))));
}

TEST(GeneratedScenes, Aircraft) {
  expect_generated_scene("aircraft", "be0cbf16a519d3d5", 100000, 6, 6);
}

TEST(GenerateScenes, SaysWhatItWrote) {
  const TemporaryFolder folder;
  ASSERT_EQ(generate(folder, "out aircraft"), 0);
  const std::string log = folder.read("log");
  EXPECT_EQ(log.substr(0, 9), "  canopy ");
  EXPECT_NE(log.find("out/aircraft/aircraft.xml: "), std::string::npos) << log;
  EXPECT_FALSE(fs::exists(folder / "out" / "statues")) << "only what was asked for";
}

TEST(GenerateScenes, WrongArguments) {
  const TemporaryFolder folder;
  EXPECT_EQ(generate(folder, ""), 2);
  EXPECT_EQ(
      folder.read("log"),
      "usage: generate_scenes OUT_DIR [SCENE]...\nscenes: aircraft, conference, statues (default: all)\n");
  EXPECT_EQ(generate(folder, "out teapot"), 2);
  EXPECT_EQ(folder.read("log"), "error: unknown scene 'teapot'; there are aircraft, conference, statues\n");
  EXPECT_FALSE(fs::exists(folder / "out"));
  folder.write("taken", "a file");
  EXPECT_EQ(generate(folder, "taken aircraft"), 3);
  EXPECT_EQ(folder.read("log").substr(0, 7), "error: ");
}

}  // namespace
}  // namespace kiloband::test
