// scripts/plant_faults.sh: makes the copy with planted faults, keeps what does not change, says what does not fit, and
// writes the patches anew. Here on a project of two files.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "tests/unit/validation/faults/shell.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;

/// The lines "1" to "10", one of which may be another.
std::string ten_lines(int number = 0, const std::string& line = "") {
  std::string text;
  for (int i = 1; i <= 10; ++i) text += (i == number ? line : std::to_string(i)) + "\n";
  return text;
}

class PlantFaults : public testing::Test {
 protected:
  PlantFaults() {
    fs::create_directories(folder_ / "scripts");
    fs::copy(fs::path(KILOBAND_SOURCE_DIR) / "scripts/plant_faults.sh", folder_ / "scripts");
    folder_.write("src_cpu/a.cpp", ten_lines());
    folder_.write("app/main.cpp", "main\n");
    folder_.write("docs/a b.md", "text\n");
    folder_.write("validation/faults/added/src/shared/planted_faults.h", "names\n");
    folder_.write(
        kPatch,
        "--- a/src_cpu/a.cpp\n+++ b/src_cpu/a.cpp\n@@ -2,7 +2,7 @@\n 2\n 3\n 4\n-5\n+five\n 6\n 7\n 8\n");
  }

  Said plant(const std::string& arguments = "") const {
    return run_shell("'" + (folder_ / "scripts/plant_faults.sh").string() + "' " + arguments);
  }
  void expect_planted(const std::string& changed) const {
    const Said said = plant();
    EXPECT_EQ(said.code, 0) << said.text;
    EXPECT_EQ(folder_.strip(said.text), kTree + ": files that are new or have changed: " + changed + "\n");
  }
  static void expect_refused(const Said& said, const std::string& because) {
    EXPECT_EQ(said.code, 1);
    EXPECT_NE(said.text.find(because), std::string::npos) << said.text;
  }

  const std::string kTree = "build/faults/tree", kPatch = "validation/faults/patches/cpu.patch";
  TemporaryFolder folder_;
};

TEST_F(PlantFaults, CopiesAndPlants) {
  expect_planted("7");
  EXPECT_EQ(folder_.read(kTree + "/src_cpu/a.cpp"), ten_lines(5, "five"));
  EXPECT_EQ(folder_.read(kTree + "/src/shared/planted_faults.h"), "names\n");
  EXPECT_EQ(folder_.read(kTree + "/docs/a b.md"), "text\n");
  EXPECT_EQ(folder_.read("src_cpu/a.cpp"), ten_lines()) << "the sources stay as they are";
}

TEST_F(PlantFaults, WhatIsTheSameKeepsItsTime) {
  expect_planted("7");
  const auto time_of = [&](const std::string& file) {
    return fs::last_write_time(folder_ / (kTree + "/" + file));
  };
  const auto planted = time_of("src_cpu/a.cpp"), other = time_of("app/main.cpp");
  expect_planted("0");
  folder_.write("app/main.cpp", "another\n");
  fs::last_write_time(folder_ / "app/main.cpp", other - std::chrono::hours(1));
  fs::remove(folder_ / "docs/a b.md");
  expect_planted("1");
  EXPECT_EQ(time_of("src_cpu/a.cpp"), planted);
  EXPECT_GT(time_of("app/main.cpp"), other) << "the build would not notice the change";
  EXPECT_FALSE(fs::exists(folder_ / (kTree + "/docs/a b.md")));
}

TEST_F(PlantFaults, CodeThatMovedStillFits) {
  folder_.write("src_cpu/a.cpp", "new\nlines\n" + ten_lines());
  expect_planted("7");
  EXPECT_EQ(folder_.read(kTree + "/src_cpu/a.cpp"), "new\nlines\n" + ten_lines(5, "five"));
}

TEST_F(PlantFaults, CodeThatChangedIsNamedAndRepaired) {
  expect_planted("7");
  folder_.write("src_cpu/a.cpp", ten_lines(4, "four"));
  const Said said = plant();
  expect_refused(said, "The code around these faults has changed");
  expect_refused(said, kTree + "/src_cpu/a.cpp.rej:@@ -2,7 +2,7 @@\n");
  EXPECT_FALSE(fs::exists(folder_ / (kTree + "/src/shared/planted_faults.h"))) << "CMake goes by this file";
  expect_refused(plant("--save"), "not in the copy yet");

  const std::string repaired = "1\n2\n3\nfour\nfive\n6\n7\n8\n9\n10\n";
  folder_.write(kTree + "/src_cpu/a.cpp", repaired);
  fs::remove(folder_ / (kTree + "/src_cpu/a.cpp.rej"));
  EXPECT_EQ(plant("--save").code, 0);
  EXPECT_NE(folder_.read(kPatch).find("\n four\n-5\n+five\n 6\n"), std::string::npos) << folder_.read(kPatch);
  expect_planted("0");
  EXPECT_EQ(folder_.read(kTree + "/src_cpu/a.cpp"), repaired);
  EXPECT_TRUE(fs::exists(folder_ / (kTree + "/src/shared/planted_faults.h")));
}

TEST_F(PlantFaults, FilesThatAreGoneAreNamed) {
  fs::rename(folder_ / "src_cpu/a.cpp", folder_ / "src_cpu/b.cpp");
  expect_refused(plant(), "src_cpu/a.cpp");
  EXPECT_FALSE(fs::exists(folder_ / (kTree + "/src/shared/planted_faults.h")));
}

TEST_F(PlantFaults, EditsAreSavedOrDropped) {
  expect_planted("7");
  const std::string before = folder_.read(kPatch);
  folder_.write(kTree + "/src_cpu/a.cpp", ten_lines(5, "dropped"));
  expect_refused(plant(), "src_cpu/a.cpp\n");
  EXPECT_EQ(plant("--discard").code, 0);
  EXPECT_EQ(folder_.read(kTree + "/src_cpu/a.cpp"), ten_lines(5, "five"));
  EXPECT_EQ(folder_.read(kPatch), before);

  folder_.write(kTree + "/src_cpu/a.cpp", ten_lines(6, "six"));
  folder_.write(kTree + "/app/main.cpp", "main\noption\n");
  folder_.write(kTree + "/src/shared/planted_faults.h", "more names\n");
  folder_.write("docs/a b.md", "edited in the sources meanwhile\n");
  EXPECT_EQ(plant("--save").code, 0);
  EXPECT_EQ(folder_.read("validation/faults/patches/program.patch"),
            "Planted faults in app, as scripts/plant_faults.sh --save has written them.\n"
            "--- a/app/main.cpp\n+++ b/app/main.cpp\n@@ -1 +1,2 @@\n main\n+option\n");
  EXPECT_EQ(folder_.read("validation/faults/added/src/shared/planted_faults.h"), "more names\n");
  expect_planted("0");
  EXPECT_EQ(folder_.read(kTree + "/src_cpu/a.cpp"), ten_lines(6, "six"));
  EXPECT_EQ(folder_.read(kTree + "/docs/a b.md"), "edited in the sources meanwhile\n");
}

TEST_F(PlantFaults, NothingElseIsSaved) {
  expect_refused(plant("--save"), "there is no ");
  expect_planted("7");
  folder_.write(kTree + "/docs/a b.md", "edited\n");
  expect_refused(plant("--save"), "docs/a b.md was edited in the copy, but is no product code");
  EXPECT_EQ(plant("--discard").code, 0);
  fs::remove(folder_ / (kTree + "/app/main.cpp"));
  expect_refused(plant("--save"), "app/main.cpp was removed from the copy");
  EXPECT_EQ(plant("--discard").code, 0);
  folder_.write(kPatch, folder_.read(kPatch) + "\n");
  expect_refused(plant("--save"), "validation/faults/patches has changed since the copy was made");
  EXPECT_EQ(plant("--what").code, 2);
}

}  // namespace
}  // namespace kiloband::test
