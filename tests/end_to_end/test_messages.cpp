// What the program says when nothing is wrong: version, contents of a scene, what was written, what to mind.
#include <gtest/gtest.h>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

TEST(Messages, Version) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(folder, {"--version"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out, "kiloband " KILOBAND_VERSION "\n");
}

TEST(Messages, InfoNamesEmittersAndTheirProbabilities) {
  const TemporaryFolder folder;
  folder.write("scene.xml", scene_text(kSensor + R"(<emitter type="constant" id="sky"/><emitter type="point"/>
<shape type="sphere" id="lamp"><emitter type="area"/></shape>)"));
  const Outcome outcome = run_program(folder, {"info", "scene.xml"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  expect_text(outcome.out, "emitters     3\n");
  expect_text(outcome.out, "  area             lamp, selected with probability 0.");
  expect_text(outcome.out, "  constant         sky, selected with probability 0.");
  expect_text(outcome.out, "  point            selected with probability 0.");
  expect_text(outcome.out,
              "path vertex  32 bytes; textured values: 16 bytes each, stored two to a 32-byte entry\n");
}

TEST(Messages, ConvertSaysWhatItWrote) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  ASSERT_EQ(run_program(folder, quiet_render("scene.xml", {"--spp", "1", "-o", "a.exr"})).code, 0);
  EXPECT_EQ(run_program(folder, {"convert", "a.exr", "b.hdr"}).err, "wrote b.hdr\n");
  EXPECT_EQ(run_program(folder, {"convert", "a.exr", "b.csv", "--pixel", "1,1"}).err, "wrote b.csv\n");
}

/// Once, whatever is made of the cube.
TEST(Messages, SensorSaysWhatItReads) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  ASSERT_EQ(run_program(folder, quiet_render("scene.xml", {"--spp", "1", "-o", "a.hdr"})).code, 0);
  folder.write("a.hdr", folder.read("a.hdr") + "reflectance scale factor = 10000\n");
  folder.write("r.csv", "nm,r\n400,1\n700,1\n");
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--png", "x.png"},
                                               {"--png", "x.png", "--picture", "false"},
                                               {"--response", "r.csv", "-o", "x.exr"}}) {
    std::vector<std::string> arguments{"sensor", "a.hdr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(folder, arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::string warning = "reflectance scale factor: not applied";
    const std::size_t first = outcome.err.find(warning);
    EXPECT_NE(first, std::string::npos) << more.front() << ": " << outcome.err;
    EXPECT_EQ(outcome.err.find(warning, first + 1), std::string::npos) << more.front() << ": " << outcome.err;
  }
}

/// What a cube has no use for is no option without effect.
TEST(Messages, OptionsOfScenesAreNotForCubes) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  ASSERT_EQ(run_program(folder, quiet_render("scene.xml", {"--spp", "1", "-o", "a.exr"})).code, 0);
  for (const auto& [option, value] :
       {std::pair{"--bands", "400:700:4"}, {"--spp", "4"}, {"--backend", "cpu"}, {"--seed", "2"}}) {
    const Outcome outcome = run_program(folder, {"view", "a.exr", "--port", "0", option, value});
    if (outcome.err.find("has no viewer") != std::string::npos) GTEST_SKIP() << outcome.err;
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err, std::string("kiloband: ") + option + ": of scenes, not of the cube a.exr\n");
  }
}

/// A render begun with few samples, and so with fewer replicates, is extended without saying so again.
TEST(Messages, ExtendedRendersKeepTheirReplicates) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  const auto run = [&](const std::string& spp, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--spp", spp, "-o", "a.hdr", "--stats", "a.json", "--checkpoint", "c"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(folder, quiet_render("scene.xml", arguments));
  };
  ASSERT_EQ(run("16", {"--variance"}).code, 0);
  EXPECT_EQ(read_cube(folder / "a.hdr").info.replicates, 8u);
  const Outcome extended = run("64", {"--resume"});
  EXPECT_EQ(extended.code, 0) << extended.err;
  EXPECT_EQ(read_cube(folder / "a.hdr").info.replicates, 8u);
  EXPECT_EQ(read_cube(folder / "a.hdr").info.samples_per_pixel, 64u);
  const Outcome other = run("128", {"--resume", "--replicates", "16"});
  EXPECT_EQ(other.code, 2);
  EXPECT_EQ(other.err,
            "kiloband: checkpoint c belongs to another render: it has 8 replicates, this one 16\n");
}

/// What was begun as one set of samples cannot get error bars later.
TEST(Messages, ExtendedRendersOfOneReplicateHaveNoErrorBars) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  const auto run = [&](const std::string& spp, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--spp", spp, "-o", "a.hdr", "--checkpoint", "c"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(folder, quiet_render("scene.xml", arguments));
  };
  ASSERT_EQ(run("16", {}).code, 0);
  for (const std::vector<std::string>& wish : std::vector<std::vector<std::string>>{
           {"--variance"}, {"--keep-replicates"}, {"--target-error", "1%"}}) {
    std::vector<std::string> more{"--resume"};
    more.insert(more.end(), wish.begin(), wish.end());
    const Outcome outcome = run("64", more);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err,
              "kiloband: " + wish.front() + ": checkpoint c has 1 replicate, and so no error bars\n");
  }
  EXPECT_EQ(run("64", {"--resume"}).code, 0);
}

TEST(Messages, FewSamplesLeaveFewerReplicates) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  const auto said = [&](bool quiet, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.xml", "-o", "a.hdr"};
    if (quiet) arguments.push_back("--quiet");
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(folder, arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.err;
  };
  // No error bars at all: a warning, before the render and even if quiet.
  const std::string warning =
      "warning: --variance: 3 samples per pixel make 1 replicate: no error bars (the variance is NaN); at "
      "least 4 "
      "are needed\n";
  EXPECT_EQ(said(true, {"--variance", "--spp", "3"}), warning);
  EXPECT_EQ(said(true, {"--variance", "--spp", "4"}), "");
  EXPECT_EQ(
      said(true, {"--keep-replicates", "--spp", "3"}),
      "warning: --keep-replicates: 3 samples per pixel make 1 replicate: no error bars; at least 4 are needed\n");
  // Fewer than were asked for: a note; the default is not something that was asked for.
  const std::string note = "note: --replicates 16: 8 samples per pixel make 4 of at least 2 samples\n";
  expect_text(said(false, {"--spp", "8", "--replicates", "16"}), note);
  EXPECT_EQ(said(true, {"--spp", "8", "--replicates", "16"}), "");
  EXPECT_EQ(said(false, {"--spp", "8"}).find("note:"), std::string::npos);
}

/// OpenImageIO brings some 250 libraries: only pictures that the program does not read itself load them.
TEST(Start, LoadsOpenImageIOOnlyForItsPictures) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  Treatment traced;
  traced.environment = {{"LD_DEBUG", "files"}};
  const auto loads = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = run_program(folder, arguments, traced);
    EXPECT_EQ(outcome.code, 0) << outcome.err.substr(0, 2000);
    return outcome.err.find("libOpenImageIO") != std::string::npos;
  };
  EXPECT_FALSE(loads({"--version"}));
  EXPECT_FALSE(loads(quiet_render("scene.xml", {"--spp", "1", "-o", "a.exr", "--preview", "a.png"})));
  const auto textured = [&](const std::string& picture) {
    folder.write("textured.xml", complete_scene(R"(<shape type="sphere"><bsdf type="diffuse">)"
                                                R"(<texture type="bitmap" name="reflectance">)"
                                                R"(<string name="filename" value=")" +
                                                picture + R"("/></texture></bsdf></shape>)"));
    return quiet_render("textured.xml", {"--spp", "1", "-o", "b.exr"});
  };
  EXPECT_FALSE(loads(textured("a.png")));
  folder.write("a.ppm", "P6\n1 1\n255\nabc");
  EXPECT_FALSE(loads(textured("a.ppm")));
  std::string targa(18, '\0');  // 1 x 1 pixel of 24 bits
  targa[2] = 2, targa[12] = targa[14] = 1, targa[16] = 24;
  folder.write("a.tga", targa + "abc");
  EXPECT_TRUE(loads(textured("a.tga")));
}

}  // namespace
}  // namespace kiloband::test
