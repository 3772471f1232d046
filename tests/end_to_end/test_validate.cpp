// kiloband validate as a user runs it.
// What its comparisons are worth: tests/unit/stats, validation/README.md.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
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

/// The oracle needs the paths' vertices, which the method pt does not keep.
TEST(Validate, HardCasesOnTheMethodWithoutVertices) {
  const TemporaryFolder folder;
  const Outcome outcome = validate(folder, {"hard/far_from_origin", "--backends", "opencl:pt", "-o", "out"});
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  const auto hard = read_json(folder, "out/results.json")["hard_cases"];
  ASSERT_EQ(hard.size(), 1u);
  bool evaluated = false;
  for (const auto& figure : hard[0]["figures"]) evaluated |= figure["name"] == "evaluation";
  EXPECT_TRUE(evaluated);
}

/// One case of hours, interrupted while it runs.
Outcome interrupted(const TemporaryFolder& folder, const std::string& name) {
  const Outcome outcome =
      run_program(folder, {"validate", "--thorough", name, "--backends", "cpu", "--no-report", "-o", "out"},
                  {.signal = SIGINT, .after_text = name, .after_seconds = 0.3});
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  return outcome;
}

/// Hours of work: it ends at once, without figures of images that were not finished.
TEST(Validate, AHardCaseIsInterrupted) {
  const TemporaryFolder folder;
  interrupted(folder, "hard/watertight");
  const auto results = read_json(folder, "out/results.json");
  EXPECT_EQ(results["interrupted"], true);
  EXPECT_TRUE(results["hard_cases"].empty());
}

/// Nor has a case that was stopped passed.
TEST(Validate, ACaseIsInterrupted) {
  const TemporaryFolder folder;
  const Outcome outcome = interrupted(folder, "cornell_box");
  EXPECT_NE(outcome.out.find("stopped  cornell_box: 0 comparisons, image means would show nothing\n"),
            std::string::npos)
      << outcome.out;
  const auto results = read_json(folder, "out/results.json");
  EXPECT_EQ(results["passed"], false);
  EXPECT_EQ(results["cases"][0]["interrupted"], true);
  EXPECT_TRUE(results["cases"][0]["pairings"].empty() && results["cases"][0]["cubes"].empty());
  EXPECT_NE(folder.read("out/junit.xml").find("errors=\"1\""), std::string::npos);
}

/// What an earlier run has left is not this one's; a folder that cannot be is found out before hours of work.
TEST(Validate, TheFolderOfResultsIsThisRuns) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "out");
  for (const char* name : {"out/report.html", "out/mitsuba.json", "out/junit.xml", "file"})
    folder.write(name, "old");
  EXPECT_EQ(validate(folder, {"analytic/planck", "--backends", "cpu", "-o", "out"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/report.html"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/mitsuba.json"));
  EXPECT_NE(folder.read("out/junit.xml"), "old");
  const Outcome refused = validate(folder, {"analytic/planck", "--backends", "cpu", "-o", "file"});
  EXPECT_NE(refused.code, 0);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(refused.err.substr(0, 16), "kiloband: file: ") << refused.err;
}

/// Names are names, whatever a shell would make of them; what was compared is counted, not what was planned.
TEST(Validate, OddNamesOfFolders) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(
      folder, {"validate", "--quick", "--quiet", "analytic/planck", "--backends", "cpu", "-o", "o'x; y"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err.find("Syntax error"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("all passed: 2 of 2 comparisons in "), std::string::npos) << outcome.out;
}

/// A black scene agrees with itself: that says nothing.
TEST(Validate, BlackImagesAreNoAgreement) {
  const TemporaryFolder folder;
  const std::filesystem::path source = KILOBAND_SOURCE_DIR;
  std::filesystem::create_directories(folder / "scenes/analytic");
  std::filesystem::create_directories(folder / "scenes/cornell_box");
  folder.write("scenes/cornell_box/cornell_box.xml",
               scene_text(kSensor + kSphere +
                          "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"0\"/></emitter>"));
  const Outcome outcome =
      validate(folder, {"cornell_box", "--root", ".", "--backends", "cpu,opencl:dpept-batch", "-o", "out"});
  EXPECT_EQ(outcome.code, 1) << outcome.out << outcome.err;
  EXPECT_NE(folder.read("out/junit.xml").find("black in every channel: nothing was compared"),
            std::string::npos);
}

/// A scene whose stated values are wrong by 2 %: the run fails, says why, and keeps what explains it.
TEST(Validate, AWrongClosedFormFails) {
  const TemporaryFolder folder;
  const std::filesystem::path source = KILOBAND_SOURCE_DIR;
  std::filesystem::create_directories(folder / "scenes/analytic");
  std::filesystem::copy(source / "scenes/analytic/spectra", folder / "scenes/analytic/spectra");
  std::string text = read_file(source / "scenes/analytic/point_light.xml");
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
  EXPECT_TRUE(std::filesystem::exists(
      folder / "out/cubes/analytic/point_light/cpu_shared_sobol_repeated__failed_.hdr"));
}

/// In the place of python3: Mitsuba 9.8.7, which does `render` of every scene.
Outcome validate_with_mitsuba(const TemporaryFolder& folder, const std::string& render,
                              const std::vector<std::string>& arguments, Treatment treatment = {}) {
  std::filesystem::create_directories(folder / "scenes/analytic");
  std::filesystem::create_directories(folder / "bin");
  folder.write("bin/python3",
               "#!/bin/sh\ncase $2 in --probe) echo '{\"mitsuba\": \"9.8.7\"}'; exit;; esac\ncd '" +
                   folder.path().string() + "'\n" + render + "\n");
  std::filesystem::permissions(folder / "bin/python3", std::filesystem::perms::owner_all);
  treatment.environment = {{"PATH", (folder / "bin").string() + ":/usr/bin:/bin"}};
  std::vector<std::string> all{"validate", "--no-report", "--root", ".", "-o", "out dir"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return run_program(folder, all, treatment);
}

TEST(Validate, ScenesAgainstMitsuba) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "validation/mitsuba/scenes");
  folder.write("validation/mitsuba/scenes/glass.xml",
               scene_text(kSensor + kSphere + "<emitter type=\"constant\"/>"));
  ASSERT_EQ(run_program(folder, {"render", "validation/mitsuba/scenes/glass.xml", "--bands", "400:700:8",
                                 "--size", "32x32", "--spp", "1024", "--replicates", "32",
                                 "--keep-replicates", "--seed", "5", "-o", "glass.hdr"})
                .code,
            0);
  const Outcome outcome =
      validate_with_mitsuba(folder, "cp glass.r* 'out dir/mitsuba'", {"mitsuba/glass", "--backends", "cpu"});
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("passed  mitsuba/glass on cpu"), std::string::npos) << outcome.out;
  const auto results = read_json(folder, "out dir/results.json");
  EXPECT_EQ(results["mitsuba"]["mitsuba"], "9.8.7");
  EXPECT_EQ(results["mitsuba"]["scenes"].size(), 1u);
  EXPECT_EQ(results["passed"], true);
}

TEST(Validate, AFailedScriptAgainstMitsubaIsAFailure) {
  const TemporaryFolder folder;
  const Outcome outcome = validate_with_mitsuba(folder, "echo 'no lamp' >&2; exit 2",
                                                {"mitsuba/glass", "--backends", "cpu,opencl:pt", "--quiet"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("FAILED  mitsuba/glass on opencl:pt: render_mitsuba.py: exit code 2: no lamp\n"),
            std::string::npos)
      << outcome.out;
  EXPECT_NE(folder.read("out dir/junit.xml").find("tests=\"2\" failures=\"2\""), std::string::npos);
}

/// The script would take longer than a test may.
TEST(Validate, StopEndsTheScriptAgainstMitsuba) {
  const TemporaryFolder folder;
  const Outcome outcome =
      validate_with_mitsuba(folder, "sleep 300", {"mitsuba", "--backends", "cpu,opencl:pt"},
                            {.signal = SIGTERM, .after_text = "mitsuba", .after_seconds = 0.5});
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_LT(outcome.seconds, 60);
  EXPECT_EQ(read_json(folder, "out dir/results.json")["interrupted"], true);
}

/// A folder of somebody else's files: modules of the interpreter's and a program of its name.
TEST(Validate, NothingOfTheCurrentFolderIsExecuted) {
  const TemporaryFolder folder;
  folder.write("python3", "#!/bin/sh\necho program >> '" + (folder / "executed").string() + "'\n");
  std::filesystem::permissions(folder / "python3", std::filesystem::perms::owner_all);
  for (const char* module : {"numpy.py", "matplotlib.py", "json.py"})
    folder.write(module, "open('" + (folder / "executed").string() + "', 'a').write(__name__)\n");
  const Outcome outcome = run_program(
      folder, {"validate", "--quick", "--quiet", "analytic/planck", "--backends", "cpu", "-o", "out"},
      {.environment = {{"PATH", ":.:/usr/bin:/bin"}, {"PYTHONPATH", ":."}}});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "executed")) << folder.read("executed");
}

TEST(Validate, WrongArguments) {
  const TemporaryFolder folder;
  const Outcome unknown = validate(folder, {"teapot"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(
      unknown.err,
      "kiloband: teapot: no case of this run has such a name (kiloband validate --list names them; some "
      "need --data, some are not in quick runs)\n");
  EXPECT_EQ(validate(folder, {"analytic/planck", "stress/hot_gaz"}).code, 2)
      << "a misspelt one beside others";
  const Outcome both = validate(folder, {"--thorough"});
  EXPECT_EQ(both.code, 2);
  EXPECT_EQ(both.err, "kiloband: --quick together with --thorough\n");
  const Outcome mitsuba = validate(folder, {"mitsuba/box"});
  EXPECT_EQ(mitsuba.code, 2);
  EXPECT_EQ(mitsuba.err,
            "kiloband: mitsuba/box: a quick run has no case against Mitsuba (leave out --quick)\n");
  const Outcome root = validate(folder, {"--root", "."});
  EXPECT_EQ(root.code, 2);
  EXPECT_EQ(root.err,
            "kiloband: .: no folder scenes/analytic there (--root must name kiloband's source folder)\n");
}

}  // namespace
}  // namespace kiloband::test
