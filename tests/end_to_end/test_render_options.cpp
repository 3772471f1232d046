// Options that change what is rendered: parameters, size, stopping rules.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

TEST(RenderOptions, DefinitionsBeatTheScenesDefaults) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_program(folder, quiet_render(cornell_box(), {"-D", "res=8", "-D", "spp=3", "-D", "bands=450:650:4",
                                                       "-o", "a.hdr", "--stats", "a.json"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube cube = read_cube(folder / "a.hdr");
  EXPECT_EQ(cube.info.width, 8u);
  EXPECT_EQ(cube.info.height, 8u);
  ASSERT_EQ(cube.info.bands.size(), 4u);
  EXPECT_EQ(cube.info.bands[0].channel.min_nm, 450);
  EXPECT_EQ(read_json(folder, "a.json")["spp"], 3);
}

TEST(RenderOptions, CommandLineBeatsTheScene) {
  const TemporaryFolder folder;
  folder.write("bands.csv", "min_nm,max_nm\n400,450\n600,601\n");
  const Outcome outcome = run_program(
      folder,
      quiet_render(cornell_box(), {"-D", "spp=3", "--spp", "2", "--size", "4x6", "--bands-file", "bands.csv",
                                   "--max-depth", "1", "-o", "a.hdr", "--stats", "a.json"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube cube = read_cube(folder / "a.hdr");
  EXPECT_EQ(cube.info.width, 4u);
  EXPECT_EQ(cube.info.height, 6u);
  ASSERT_EQ(cube.info.bands.size(), 2u);
  EXPECT_EQ(cube.info.bands[1].channel.max_nm, 601);
  const nlohmann::json stats = read_json(folder, "a.json");
  EXPECT_EQ(stats["spp"], 2);
  // Depth 1 is emission only: no shadow rays.
  EXPECT_EQ(stats["rays"], stats["paths"]);
}

/// A square of 1 m at 1 m in a field of view of 90 degrees along `axis`: 2 m of that side
/// of the image are seen.
std::size_t pixels_of_the_square(const TemporaryFolder& folder, const std::string& axis,
                                 const std::string& size) {
  folder.write("square.xml", scene_text(R"(<sensor type="perspective"><float name="fov" value="90"/>
<string name="fov_axis" value=")" + axis +
                                        R"("/></sensor><emitter type="constant"/>
<shape type="rectangle"><transform name="to_world"><scale x="0.5" y="0.5"/><translate z="1"/></transform></shape>)"));
  const Outcome outcome =
      run_program(folder, quiet_render("square.xml", {"--size", size, "--spp", "1", "--bands", "500-600",
                                                      "--aov", "object", "-o", "square.hdr"}));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Cube cube = read_cube(folder / "square.hdr");
  return static_cast<std::size_t>(std::count(cube.aux.begin(), cube.aux.end(), 0.0f));
}

TEST(RenderOptions, SizeKeepsTheFieldOfViewsAxis) {
  const TemporaryFolder folder;
  // 16 x 8: along x half of the columns and all rows; along y half of the rows and a quarter of the columns.
  EXPECT_EQ(pixels_of_the_square(folder, "x", "16x8"), 8u * 8);
  EXPECT_EQ(pixels_of_the_square(folder, "y", "16x8"), 4u * 4);
  EXPECT_EQ(pixels_of_the_square(folder, "x", "8x16"), 4u * 4);
  EXPECT_EQ(pixels_of_the_square(folder, "y", "8x16"), 8u * 8);
}

/// Samples are dealt to replicates where error bars are wanted alone: sobol pays for them.
TEST(RenderOptions, OneReplicateUnlessErrorBarsAreWanted) {
  const TemporaryFolder folder;
  const auto render = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> options{"--size", "16x16",   "--bands", "400:700:4", "--spp",
                                     "32",     "--stats", "a.json",  "-o",        output};
    options.insert(options.end(), more.begin(), more.end());
    const Outcome outcome = run_program(folder, quiet_render(cornell_box(), options));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return read_json(folder, "a.json")["replicates"].get<int>();
  };
  EXPECT_EQ(render("a.hdr", {}), 1);
  EXPECT_EQ(render("b.hdr", {"--replicates", "1"}), 1);
  EXPECT_EQ(folder.read("a.img"), folder.read("b.img"));
  EXPECT_EQ(render("c.hdr", {"--replicates", "16"}), 16);
  EXPECT_NE(folder.read("a.img"), folder.read("c.img"));
  for (const std::vector<std::string>& wish : std::vector<std::vector<std::string>>{
           {"--variance"}, {"--keep-replicates"}, {"--target-error", "0.001%"}}) {
    EXPECT_EQ(render("d.hdr", wish), 16) << wish.front();
    EXPECT_EQ(folder.read("d.img"), folder.read("c.img")) << wish.front();
  }
}

TEST(RenderOptions, TimeStops) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(
      folder, quiet_render(cornell_box(), {"--size", "16x16", "--bands", "400:700:4", "--time", "0.5s", "-o",
                                           "a.hdr", "--stats", "a.json", "--variance"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json stats = read_json(folder, "a.json");
  // One sample of a block (32 x 32) is the grain: far below a second even with sanitizers
  // and a loaded machine.
  EXPECT_GE(stats["seconds"].get<double>(), 0.45);
  EXPECT_LT(stats["seconds"].get<double>(), 5);
  EXPECT_GE(stats["spp"].get<uint64_t>(), 16u);
  EXPECT_EQ(stats["replicates"], 16);
  EXPECT_EQ(stats["interrupted"], false);
}

TEST(RenderOptions, TargetErrorStops) {
  const TemporaryFolder folder;
  for (const bool variance : {false, true}) {
    std::vector<std::string> options{"--size", "16x16", "--bands", "400:700:4", "--target-error",
                                     "20%",    "-o",    "a.hdr",   "--stats",   "a.json"};
    if (variance) options.push_back("--variance");
    const Outcome outcome = run_program(folder, quiet_render(cornell_box(), options));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const nlohmann::json stats = read_json(folder, "a.json");
    ASSERT_TRUE(stats["mean_relative_error"].is_number());
    EXPECT_GT(stats["mean_relative_error"].get<double>(), 0);
    EXPECT_LE(stats["mean_relative_error"].get<double>(), 0.2);
    EXPECT_EQ(stats["ended_by"], "target-error");
  }
}

/// A sky that is dark in the second channel of three; its radiance varies inside the others.
TEST(RenderOptions, SamplesLimitTheTargetErrorAndTheWorstChannelIsNamed) {
  const TemporaryFolder folder;
  folder.write(
      "scene.xml",
      scene_text(kSensor + R"(<emitter type="constant"><spectrum name="radiance" value="400:1, 499:2, )"
                           R"(499.001:0, 601:0, 601.001:1, 700:3"/></emitter>)"));
  const Outcome outcome =
      run_program(folder, {"render", "scene.xml", "--bands", "400:700:3", "--spp", "64", "--target-error",
                           "0.001%", "--stats", "a.json", "-o", "a.hdr"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json stats = read_json(folder, "a.json");
  EXPECT_EQ(stats["ended_by"], "spp");
  EXPECT_EQ(stats["spp"], 64);
  EXPECT_EQ(stats["replicates"], 16);
  EXPECT_EQ(stats["dark_channels"], 1);
  const auto& worst = stats["worst_channel"];
  EXPECT_EQ(worst["name"], worst["index"] == 0 ? "400-500 nm" : "600-700 nm");
  EXPECT_EQ(worst["max_nm"].get<double>() - worst["min_nm"].get<double>(), 100);
  const std::string figures = fmt::format(
      "relative error (RMS of the pixels over the image's mean): {:.3g} % in the worst channel ({}), {:.3g} "
      "% in the median one; channels without light, left out: 1\n",
      100 * stats["worst_relative_error"].get<double>(), worst["name"].get<std::string>(),
      100 * stats["median_relative_error"].get<double>());
  expect_text(outcome.err, figures);
  expect_text(outcome.err, "ended by --spp\n");
  expect_text(outcome.err, "warning: --target-error 0.001% was not reached: ended by --spp; " + figures);
}

/// Not octal, as scripts with numbers of a fixed length need it.
TEST(RenderOptions, NumbersAreDecimalWhateverTheyBeginWith) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(
      folder, quiet_render(cornell_box(),
                           {"--size", "8x8", "--bands", "400:700:4", "--spp", "064", "--replicates", "010",
                            "--seed", "010", "--threads", "08", "-o", "a.hdr", "--stats", "a.json"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json stats = read_json(folder, "a.json");
  EXPECT_EQ(stats["spp"], 64);
  EXPECT_EQ(stats["replicates"], 10);
  EXPECT_EQ(stats["seed"], 10);
}

TEST(RenderOptions, WhatEndsBeforeThereAreErrorsIsNotDark) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_program(folder, {"render", cornell_box(), "--size", "8x8", "--bands", "400:700:4", "--backend",
                           "cpu", "--time", "1e-9", "--target-error", "1%", "-o", "a.exr"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  expect_text(outcome.err,
              "warning: --target-error 1% was not reached: ended by --time; no relative error: no pixel has "
              "samples in two replicates\n");
}

}  // namespace
}  // namespace kiloband::test
