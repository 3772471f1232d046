// How the suite finds Mitsuba and reads what the script found, with shell scripts in the interpreter's place.
#include "validation/suite/mitsuba.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/messages.hpp"
#include "validation/suite/results.hpp"

namespace kiloband::validation {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// An interpreter: $1 is the Python script, what follows its options.
std::string interpreter(const test::TemporaryFolder& folder, const std::string& name,
                        const std::string& body) {
  const fs::path file = folder.write(name, "#!/bin/sh\n" + body + "\n");
  fs::permissions(file, fs::perms::owner_all);
  return file.string();
}

/// Has Mitsuba 9.8.7 and the scenes box and ball; otherwise does `body`.
std::string with_mitsuba(const test::TemporaryFolder& folder, const std::string& body = "exit 2") {
  return interpreter(
      folder, "with",
      "case $2 in --probe) echo warning >&2; echo 9.8.7;; --list) printf 'box\\nball\\n';; *) " + body +
          ";; esac");
}

json entry(const std::string& name, const std::string& backend, bool passed) {
  json pixels;
  if (!passed) pixels = {{"name", "mean/tile"}, {"p", 1e-12}};
  return {{"name", name},
          {"backend", backend},
          {"passed", passed},
          {"p", 0.25},
          {"level", 1e-6},
          {"largest_difference", -0.0012},
          {"detectable", {{"typical", 0.003}, {"largest", 0.004}, {"power", 0.9}}},
          {"seconds_ours", 1.5},
          {"error", {0.1, 0.2}},
          {"pixels", pixels}};
}

std::string record(const std::vector<json>& scenes) {
  return json{{"mitsuba", "9.8.7"}, {"variant", "v"}, {"python", "3.1"}, {"numpy", "1.2"}, {"scenes", scenes}}
      .dump();
}

const MitsubaRun kRun{"kiloband", ".", {"box"}, {"cpu", "opencl:pt"}, Effort::kStandard, 1};

ChildEnd ended(int code, const std::string& err = "") {
  ChildEnd end;
  end.code = code;
  end.err = err;
  return end;
}

TEST(FindMitsuba, TheFirstInterpreterThatHasIt) {
  const test::TemporaryFolder folder;
  const std::string without = interpreter(folder, "without", "echo 1.0; exit 1"), with = with_mitsuba(folder);
  const auto driver = find_mitsuba({{"./no python", without, with}, "compare.py"}, {}, Effort::kStandard);
  ASSERT_TRUE(driver);
  EXPECT_EQ(driver->interpreter, with);
  EXPECT_EQ(driver->version, "9.8.7");
  EXPECT_EQ(driver->scenes, (std::vector<std::string>{"box", "ball"}));
  EXPECT_FALSE(find_mitsuba({{"./no python", without}, "compare.py"}, {}, Effort::kThorough));
}

TEST(FindMitsuba, OnlyWhereARunWantsIt) {
  EXPECT_TRUE(wants_mitsuba({}, Effort::kStandard));
  EXPECT_TRUE(wants_mitsuba({"hard/", "mits"}, Effort::kThorough));
  EXPECT_TRUE(wants_mitsuba({"mitsuba/box"}, Effort::kStandard));
  EXPECT_FALSE(wants_mitsuba({"cornell_box"}, Effort::kStandard));
  EXPECT_FALSE(wants_mitsuba({}, Effort::kQuick));
  const test::TemporaryFolder folder;
  EXPECT_FALSE(find_mitsuba({{with_mitsuba(folder)}, "compare.py"}, {"cornell_box"}, Effort::kStandard));
}

TEST(FindMitsuba, ANameThatAsksForItIsAnErrorWithoutIt) {
  const test::TemporaryFolder folder;
  const std::string without = interpreter(folder, "without", "exit 2");
  EXPECT_EQ(
      test::error_of([&] {
        find_mitsuba({{without, "./python"}, "compare.py"}, {"hard/", "mitsuba/box"}, Effort::kStandard);
      }),
      "mitsuba/box: Mitsuba 3 is not there (pip install mitsuba scipy), looked for by " + without +
          " and ./python");
  EXPECT_EQ(test::error_of([&] {
              find_mitsuba({{with_mitsuba(folder)}, "c.py"}, {"mitsuba/box"}, Effort::kQuick);
            }),
            "mitsuba/box: a quick run has no case against Mitsuba (leave out --quick)");
}

TEST(FindMitsuba, ItsScenesAreCasesOfTheRun) {
  SuiteSettings settings;
  settings.mitsuba = MitsubaDriver{"python", "9.8.7", "compare.py", {"box", "ball"}};
  settings.folders.scenes = fs::path(KILOBAND_SOURCE_DIR) / "scenes";
  settings.names = {"mitsuba/"};
  EXPECT_EQ(planned_names(settings), (std::vector<std::string>{"mitsuba/box", "mitsuba/ball"}));
  settings.names = {"mitsuba/ba"};
  EXPECT_EQ(planned_names(settings), std::vector<std::string>{"mitsuba/ball"});
}

TEST(Mitsuba, ComparesOneBackendOfEachKindUnlessThorough) {
  const std::vector<std::string> all{"cpu", "opencl:pt", "opencl:dpept-path"};
  EXPECT_EQ(mitsuba_backends(all, Effort::kStandard), (std::vector<std::string>{"cpu", "opencl:pt"}));
  EXPECT_EQ(mitsuba_backends(all, Effort::kThorough), all);
}

TEST(ReadMitsuba, EverySceneOnEveryBackend) {
  const MitsubaResult result =
      read_mitsuba(record({entry("box", "opencl:pt", false), entry("box", "cpu", true)}), kRun, ended(1));
  EXPECT_EQ(result.record,
            (json{{"mitsuba", "9.8.7"}, {"variant", "v"}, {"python", "3.1"}, {"numpy", "1.2"}}));
  ASSERT_EQ(result.scenes.size(), 2u);
  const MitsubaScene& good = result.scenes[0];
  EXPECT_EQ(good.backend, "cpu");
  EXPECT_TRUE(good.passed);
  EXPECT_EQ(good.failure, "");
  EXPECT_EQ(good.entry, entry("box", "cpu", true));
  EXPECT_EQ(good.figure("/detectable/typical"), 0.003);
  EXPECT_TRUE(std::isnan(good.figure("/pixels/p")));
  EXPECT_FALSE(result.scenes[1].passed);
  EXPECT_EQ(result.scenes[1].failure,
            "channel means: p 0.25, level 1e-06, largest difference -0.12 %; mean/tile: p 1e-12");
  EXPECT_FALSE(result.passed());
}

TEST(ReadMitsuba, WhatIsMissingHasFailed) {
  const std::string one = record({entry("box", "cpu", true)});
  const MitsubaResult crashed = read_mitsuba(one, kRun, ended(2, "Traceback\nValueError: no\n"));
  ASSERT_EQ(crashed.scenes.size(), 2u);
  EXPECT_TRUE(crashed.scenes[0].passed);
  EXPECT_FALSE(crashed.scenes[1].passed);
  EXPECT_EQ(crashed.scenes[1].backend, "opencl:pt");
  EXPECT_EQ(crashed.scenes[1].failure, "compare_with_mitsuba.py: exit code 2: ValueError: no");
  EXPECT_TRUE(std::isnan(crashed.scenes[1].figure("/p")));
  const MitsubaResult silent = read_mitsuba("", kRun, ended(0));
  ASSERT_EQ(silent.scenes.size(), 2u);
  EXPECT_EQ(silent.scenes[0].failure, "compare_with_mitsuba.py: exit code 0");
  EXPECT_FALSE(silent.passed());
}

TEST(ReadMitsuba, WhatCannotBeReadHasFailed) {
  json wrong = entry("box", "cpu", true);
  wrong["passed"] = "yes";
  for (const std::string& text : {std::string("{\"mitsuba\": NaN"), std::string("[]"), std::string("{}"),
                                  record({wrong}), record({json(7)})}) {
    const MitsubaResult result = read_mitsuba(text, kRun, ended(0));
    ASSERT_EQ(result.scenes.size(), 2u) << text;
    EXPECT_FALSE(result.passed()) << text;
    EXPECT_TRUE(result.scenes[0].failure.starts_with("mitsuba.json cannot be read: "))
        << result.scenes[0].failure;
  }
}

TEST(ReadMitsuba, AFailureBehindTheLastSceneIsOne) {
  ChildEnd end;
  end.signal = 11;
  const std::string all = record({entry("box", "cpu", true), entry("box", "opencl:pt", true)});
  const MitsubaResult result = read_mitsuba(all, kRun, end);
  EXPECT_TRUE(result.scenes[0].passed);
  EXPECT_EQ(result.scenes[1].failure, "compare_with_mitsuba.py: ended by signal 11");
  EXPECT_FALSE(result.passed());
}

TEST(ReadMitsuba, AStoppedRunHasWhatItCameTo) {
  ChildEnd end;
  end.signal = 15;
  end.stopped = true;
  EXPECT_TRUE(read_mitsuba("", kRun, end).scenes.empty());
  const MitsubaResult result = read_mitsuba(record({entry("box", "cpu", true)}), kRun, end);
  ASSERT_EQ(result.scenes.size(), 1u);
  EXPECT_TRUE(result.passed());
}

TEST(RunMitsuba, RunsTheScriptAndReadsItsFile) {
  const test::TemporaryFolder folder;
  folder.write("fresh.json", record({entry("box", "cpu", true), entry("box", "opencl:pt", true)}));
  folder.write("mitsuba.json", record({entry("ball", "cpu", false)}));
  const std::string at = "'" + folder.path().string() + "'";
  const std::string python = with_mitsuba(
      folder, "test ! -e " + at + "/mitsuba.json || exit 9; echo \"$*\" > " + at + "/arguments; cp " + at +
                  "/fresh.json " + at + "/mitsuba.json; echo row; echo row");
  MitsubaRun run{"/bin/kiloband", folder.path(), {"box"}, {"cpu", "opencl:pt"}, Effort::kStandard, 7};
  std::vector<double> progress;
  const Watch watch{nullptr, [&](double fraction) { progress.push_back(fraction); }};
  const MitsubaResult result = run_mitsuba({python, "9.8.7", "compare.py", {"box", "ball"}}, run, watch);
  EXPECT_TRUE(result.passed());
  EXPECT_EQ(result.scenes.size(), 2u);
  EXPECT_EQ(progress, (std::vector<double>{0.5, 1}));
  EXPECT_EQ(folder.read("arguments"),
            "compare.py /bin/kiloband -o " + folder.path().string() +
                " --backends cpu,opencl:pt --seed 7 --rate 1e-05 --effort 0.25 --scenes box\n");
}

/// What keeps the script from being run has failed, as what it could not do:
/// an hour of other cases is not lost.
TEST(RunMitsuba, AResultThatCannotBeReplacedIsAFailure) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder.path() / "mitsuba.json" / "not empty");
  MitsubaRun run = kRun;
  run.output = folder.path();
  const MitsubaResult result = run_mitsuba({with_mitsuba(folder), "9.8.7", "compare.py", {"box"}}, run, {});
  ASSERT_EQ(result.scenes.size(), 2u);
  EXPECT_FALSE(result.passed());
  EXPECT_TRUE(result.scenes[0].failure.starts_with("compare_with_mitsuba.py: not started: "))
      << result.scenes[0].failure;
  EXPECT_NE(result.scenes[0].failure.find("mitsuba.json"), std::string::npos) << result.scenes[0].failure;
}

/// A scene against Mitsuba that fails is a failure of the run, once in each file.
TEST(RunMitsuba, IsPartOfTheResults) {
  SuiteResult result;
  EXPECT_TRUE(result.passed());
  EXPECT_FALSE(to_json(result, {}).contains("mitsuba"));
  result.mitsuba = read_mitsuba(record({entry("box", "cpu", true)}), kRun, ended(2, "no <device>"));
  EXPECT_FALSE(result.passed());
  const json section = to_json(result, {})["mitsuba"];
  EXPECT_EQ(section["mitsuba"], "9.8.7");
  ASSERT_EQ(section["scenes"].size(), 2u);
  EXPECT_EQ(section["scenes"][0]["passed"], true);
  EXPECT_EQ(section["scenes"][0]["detectable"]["typical"], 0.003);
  EXPECT_EQ(section["scenes"][0]["error"], json({0.1, 0.2}));
  EXPECT_FALSE(section["scenes"][1].contains("p"));
  EXPECT_EQ(section["scenes"][1]["failure"], "compare_with_mitsuba.py: exit code 2: no <device>");
  const std::string junit = to_junit(result);
  EXPECT_NE(junit.find("tests=\"2\" failures=\"1\""), std::string::npos) << junit;
  EXPECT_NE(junit.find("<testcase classname=\"mitsuba/box\" name=\"cpu\" time=\"1.500\"/>"),
            std::string::npos)
      << junit;
  EXPECT_NE(junit.find("exit code 2: no &lt;device&gt;"), std::string::npos) << junit;
}

}  // namespace
}  // namespace kiloband::validation
