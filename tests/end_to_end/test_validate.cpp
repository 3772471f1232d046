// kiloband validate as a user runs it. What its comparisons are worth: tests/unit/stats,
// validation/README.md.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

Outcome validate(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"validate", "--quick", "--quiet", "--no-report"});
  return run_program(folder, arguments);
}

TEST(Validate, NamesItsCases) {
  const TemporaryFolder folder;
  const Outcome outcome = validate(folder, {"--list"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* name : {"analytic/furnace", "analytic/isothermal", "cornell_box", "stress/hot_gas",
                           "hard/", "convergence/cornell_box"})
    EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
  EXPECT_FALSE(std::filesystem::exists(folder / "validation_results"));
}

TEST(Validate, ClosedFormsOnEveryBackend) {
  const TemporaryFolder folder;
  const Outcome outcome = validate(folder, {"analytic/furnace", "analytic/enclosure", "-o", "out"});
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  const auto results = read_json(folder, "out/results.json");
  EXPECT_EQ(results["passed"], true);
  ASSERT_EQ(results["cases"].size(), 2u);
  EXPECT_EQ(results["comparisons"], 10) << "two cases, four backends and another mode of the first";
  for (const auto& c : results["cases"]) {
    for (const auto& pairing : c["pairings"]) {
      EXPECT_EQ(pairing["b"], "closed form");
      EXPECT_EQ(pairing["attempts"], 1);
      EXPECT_EQ(pairing["invalid_samples"], 0);
      ASSERT_EQ(pairing["tests"].size(), 1u) << "the image mean alone";
      const double bias = pairing["tests"][0]["detectable"]["largest"];
      EXPECT_GE(bias, 0) << "not a number?";
      EXPECT_LT(bias, 0.05);
    }
  }
  const std::string junit = folder.read("out/junit.xml");
  EXPECT_NE(junit.find("tests=\"10\" failures=\"0\""), std::string::npos) << junit;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/cubes/analytic/furnace/cpu_shared_sobol.hdr"));
}

TEST(Validate, BackendsAgreeOnTheCornellBox) {
  const TemporaryFolder folder;
  const Outcome outcome =
      validate(folder, {"cornell_box", "--backends", "cpu,opencl:dpept-batch", "-o", "out", "--seed", "3"});
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  const auto results = read_json(folder, "out/results.json");
  std::set<std::string> tests, kinds;
  for (const auto& pairing : results["cases"][0]["pairings"]) {
    kinds.insert(pairing["kind"]);
    for (const auto& test : pairing["tests"]) tests.insert(test["name"]);
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"independent", "paired"}));
  for (const char* name : {"mean/pixel", "mean/tile", "mean/image", "variance/pixel", "variance/image"})
    EXPECT_TRUE(tests.contains(name)) << name;
}

/// A scene whose stated values are wrong by 2 %: the run fails, says why, and keeps what explains it.
TEST(Validate, AWrongClosedFormFails) {
  const TemporaryFolder folder;
  const std::filesystem::path source = KILOBAND_SOURCE_DIR;
  std::filesystem::create_directories(folder / "scenes/analytic");
  std::filesystem::copy(source / "scenes/analytic/spectra", folder / "scenes/analytic/spectra");
  std::ifstream file(source / "scenes/analytic/point_light.xml");
  std::string text(std::istreambuf_iterator<char>(file), {});
  const auto at = text.find("Expected: ") + 10;
  const double value = std::stod(text.substr(at));
  text.replace(at, text.find(',', at) - at, std::to_string(value * 1.02));
  folder.write("scenes/analytic/point_light.xml", text);
  const Outcome outcome = validate(folder, {"analytic", "--root", ".", "--backends", "cpu", "-o", "out"});
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  EXPECT_NE(outcome.out.find("FAILED  analytic/point_light"), std::string::npos) << outcome.out;
  const auto pairing = read_json(folder, "out/results.json")["cases"][0]["pairings"][0];
  EXPECT_EQ(pairing["passed"], false);
  EXPECT_EQ(pairing["attempts"], 2) << "repeated with fresh seeds";
  EXPECT_EQ(pairing["samples"], 256) << "and four times the samples";
  EXPECT_TRUE(
      std::filesystem::exists(folder / "out/cubes/analytic/point_light/cpu_shared_sobol__failed_.hdr"));
}

TEST(Validate, WrongArguments) {
  const TemporaryFolder folder;
  const Outcome unknown = validate(folder, {"teapot"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err,
            "kiloband: no case of the suite has such a name (kiloband validate --list names them)\n");
  const Outcome both = validate(folder, {"--thorough"});
  EXPECT_EQ(both.code, 2);
  EXPECT_EQ(both.err, "kiloband: --quick together with --thorough\n");
  const Outcome root = validate(folder, {"--root", "."});
  EXPECT_EQ(root.code, 2);
  EXPECT_EQ(root.err,
            "kiloband: .: no folder scenes/analytic there (--root must name kiloband's source folder)\n");
}

}  // namespace
}  // namespace kiloband::test
