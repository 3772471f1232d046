// Results that say nothing must not pass: invalid samples, black images, runs that were stopped.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"
#include "validation/suite/results.hpp"

namespace kiloband::test {
namespace {

using validation::Case;
using validation::CaseResult;
using validation::ConvergenceResult;
using validation::Effort;

/// 8x8 pixels that look at a wall.
std::string wall_under(const std::string& lights) {
  return R"(<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='2'/></integrator>
<sensor type='orthographic'>
 <transform name='to_world'><scale value='1e-9'/><lookat origin='0,0,1' target='0,0,0' up='0,1,0'/></transform>
 <film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='8'/><rfilter type='box'/></film>
</sensor><shape type='rectangle'/>)" +
         lights + "</scene>";
}

/// A lamp 1e-18 m before the wall: a sample that selects it, which happens seldom, is beyond floats.
const std::string kBeyondFloats = wall_under(
    "<emitter type='point'><point name='position' x='0' y='0' z='1e-18'/><spectrum name='intensity' "
    "value='0.01'/></emitter><emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/>"
    "<spectrum name='irradiance' value='2'/></emitter>");

const std::string kBlack =
    wall_under("<emitter type='constant'><spectrum name='radiance' value='0'/></emitter>");

struct NoEvidence : testing::Test {
  TemporaryFolder folder;
  std::atomic<bool> stop = false;
  validation::Watch watch{&stop, {}};

  validation::CaseScene scene(const std::string& text) const {
    return {folder.write("scene.xml", text), {}, "500:600:4"};
  }
  CaseResult run_case(const std::string& text) const {
    return validation::run_case({"case", "", scene(text), {16, 16, 16}}, {{"cpu"}, Effort::kQuick}, watch);
  }
  ConvergenceResult run_convergence(const std::string& text) const {
    return validation::run_convergence({"study", scene(text), {8, 8, 8}}, {{"cpu"}, Effort::kQuick}, watch);
  }
};

TEST_F(NoEvidence, InvalidSamplesFailACaseWithoutARepetition) {
  const CaseResult result = run_case(kBeyondFloats);
  ASSERT_EQ(result.error, "");
  ASSERT_EQ(result.pairings.size(), 1u);
  EXPECT_FALSE(result.passed);
  EXPECT_GT(result.pairings[0].invalid_samples, 0u);
  EXPECT_EQ(result.pairings[0].attempts, 1);
}

TEST_F(NoEvidence, BlackImagesFailACase) {
  const CaseResult result = run_case(kBlack);
  ASSERT_EQ(result.error, "");
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.pairings.at(0).comparison.notes.back(), "black in every channel: nothing was compared");
}

TEST_F(NoEvidence, AStoppedCaseHasNoVerdict) {
  stop = true;
  const CaseResult result = run_case(kBeyondFloats);
  EXPECT_TRUE(result.interrupted);
  EXPECT_TRUE(result.pairings.empty() && result.images.empty());
  EXPECT_EQ(result.error, "");
}

/// What is kept on the way says of itself that it is not all.
TEST_F(NoEvidence, WhatIsKeptOnTheWayIsInterrupted) {
  validation::SuiteSettings settings;
  settings.names = {"analytic/blend", "analytic/disk_light"};
  settings.effort = Effort::kQuick;
  const std::filesystem::path root = KILOBAND_SOURCE_DIR;
  settings.folders = {root / "scenes", root / "validation/scenes", folder.path() / "scenes", {}};
  settings.output = folder.path();
  std::vector<std::size_t> kept;
  const validation::SuiteResult result = validation::run_suite(
      settings, watch, [](const std::string&) {},
      [&](const validation::SuiteResult& so_far) {
        EXPECT_TRUE(so_far.interrupted);
        EXPECT_FALSE(so_far.passed());
        kept.push_back(so_far.cases.size());
        validation::write_verdicts(folder.path(), so_far, {});
      });
  EXPECT_EQ(kept, (std::vector<std::size_t>{1, 2}));
  EXPECT_FALSE(result.interrupted);
  EXPECT_TRUE(std::filesystem::exists(folder / "results.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "cubes"));
}

/// A path in a message has any bytes, such as Latin-1's e with an acute accent: the other verdicts are kept.
TEST_F(NoEvidence, MessagesWithBytesThatAreNoTextAreWritten) {
  validation::SuiteResult result;
  result.cases.emplace_back().error = "cannot open 'd\xe9'";
  validation::write_verdicts(folder.path(), result, {});
  const std::string readable = "cannot open 'd\xef\xbf\xbd'";
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(folder / "results.json"))["cases"][0]["error"], readable);
  std::ifstream junit(folder / "junit.xml");
  const std::string text{std::istreambuf_iterator<char>(junit), {}};
  EXPECT_NE(text.find(readable), std::string::npos) << text;
}

TEST_F(NoEvidence, ConvergenceOfBlackImagesFails) {
  const ConvergenceResult result = run_convergence(kBlack);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(
      result.note.find("cpu shared sobol: no slope: an image without noise, or with values that are not "
                       "finite; cpu shared independent: no slope"),
      0u)
      << result.note;
}

TEST_F(NoEvidence, InvalidSamplesFailConvergence) {
  const ConvergenceResult result = run_convergence(kBeyondFloats);
  EXPECT_FALSE(result.passed);
  EXPECT_NE(result.note.find("invalid samples; "), std::string::npos) << result.note;
}

TEST_F(NoEvidence, AStoppedStudyHasNoVerdict) {
  stop = true;
  const ConvergenceResult result = run_convergence(kBeyondFloats);
  EXPECT_TRUE(result.interrupted);
  EXPECT_TRUE(result.curves.empty());
  EXPECT_EQ(result.note, "");
}

/// A pixel without noise that differs is the clearest difference of all: not a hole in the map.
TEST(Results, InfiniteDifferencesAreShown) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  validation::SuiteResult result;
  CaseResult& c = result.cases.emplace_back();
  stats::ScaleResult& pixels = c.pairings.emplace_back().comparison.means.emplace_back();
  pixels.t_map = {1, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()};
  const auto json = validation::to_json(result, {});
  EXPECT_EQ(json["cases"][0]["pairings"][0]["means"][0]["t_map"].dump(), "[1.0,1e+30,-1e+30,null]");
}

}  // namespace
}  // namespace kiloband::test
