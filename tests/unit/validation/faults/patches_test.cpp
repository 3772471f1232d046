// The patches that plant faults (validation/faults/patches) fit the sources as they are, and plant every fault of the
// table where the table says that it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "tests/unit/validation/faults/shell.hpp"
#include "validation/faults/table.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

const fs::path kRoot = KILOBAND_SOURCE_DIR;
const std::string kAdded = "validation/faults/added/src/";

/// None where the file does not exist.
Lines lines_of(const fs::path& path) {
  std::ifstream file(path);
  Lines lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// "cpu", "opencl", "shared" (of the faults with that prefix) or "program".
Lines patch_lines(const std::string& name) {
  return lines_of(kRoot / ("validation/faults/patches/" + name + ".patch"));
}

/// A place that a patch changes.
struct Hunk {
  std::string file, heading;
  Lines before;  // of the file, as they must be
};

std::vector<Hunk> hunks_of(const std::string& name) {
  std::vector<Hunk> hunks;
  std::string file;
  for (const std::string& line : patch_lines(name)) {
    if (line.starts_with("--- a/")) {
      file = line.substr(6);
    } else if (line.starts_with("@@ ")) {
      hunks.push_back({file, line, {}});
    } else if (!hunks.empty() &&
               (line.starts_with(' ') || (line.starts_with('-') && !line.starts_with("--- ")))) {
      hunks.back().before.push_back(line.substr(1));
    }
  }
  return hunks;
}

std::size_t occurrences(const Lines& text, const Lines& part) {
  std::size_t count = 0;
  for (auto from = text.begin(); from != text.end(); ++from, ++count) {
    from = std::search(from, text.end(), part.begin(), part.end());
    if (from == text.end()) break;
  }
  return count;
}

TEST(FaultPatches, EveryHunkFitsOnePlaceAlone) {
  for (const std::string name : {"cpu", "opencl", "shared", "program"}) {
    const std::vector<Hunk> hunks = hunks_of(name);
    EXPECT_FALSE(hunks.empty()) << name;
    for (const Hunk& hunk : hunks) {
      ASSERT_GE(hunk.before.size(), 3u) << "the scan of " << name << ".patch has lost its way";
      EXPECT_EQ(occurrences(lines_of(kRoot / hunk.file), hunk.before), 1u)
          << hunk.file << " " << hunk.heading
          << "\nThe code around a planted fault has changed: scripts/plant_faults.sh says what to do";
    }
  }
}

TEST(FaultPatches, ApplyToTheSources) {
  const TemporaryFolder folder;
  const Said said =
      run_shell("'" + (kRoot / "scripts/plant_faults.sh").string() + "' '" + folder.path().string() + "'");
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_TRUE(fs::exists(folder / "tree/src/shared/planted_faults.h"));
}

/// The enumeration's names without prefix; the position is the number, 0 is none.
Lines enumerators() {
  static const std::regex kEnumerator("  KB_PLANTED_([A-Z_]+)(?: = 0)?,");
  Lines names;
  for (const std::string& line : lines_of(kRoot / (kAdded + "shared/planted_faults.h"))) {
    if (std::smatch match; std::regex_match(line, match, kEnumerator)) names.push_back(match[1]);
  }
  return names;
}

/// What a patch adds to files.
std::string added_text(const std::string& name) {
  std::string text;
  for (const std::string& line : patch_lines(name)) {
    if (line.starts_with('+')) text += line + "\n";
  }
  return text;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// TILE_BIAS and PIXEL_BIAS are in a helper, to which a patch gives the number of the selected fault.
bool is_planted(const std::string& text, const std::string& suffix, const std::string& fault) {
  if (contains(text, "KB_PLANTED" + suffix + "(" + fault + ")")) return true;
  const Lines helpers = lines_of(kRoot / (kAdded + "render/planted_helpers.hpp"));
  return contains(text, "plant_in_means(KB_PLANTED" + suffix + "_NUMBER") &&
         std::ranges::any_of(helpers, [&](const std::string& line) {
           return contains(line, "fault == KB_PLANTED_" + fault + " ");
         });
}

TEST(FaultPatches, PlantEveryFaultWhereTheTableSays) {
  const Lines names = enumerators();
  const std::string cpu = added_text("cpu"), opencl = added_text("opencl"), shared = added_text("shared");
  ASSERT_EQ(names.size(), faults::planted_faults().size() + 1);  // with "none"
  for (const faults::PlantedFault& fault : faults::planted_faults()) {
    const std::string& name = names.at(fault.number);
    EXPECT_EQ(is_planted(cpu, "", name), (fault.where & faults::kCpu) != 0) << fault.name << " in cpu.patch";
    EXPECT_EQ(is_planted(opencl, "", name) || is_planted(opencl, "_OPENCL", name),
              (fault.where & faults::kOpencl) != 0)
        << fault.name << " in opencl.patch";
    EXPECT_EQ(is_planted(shared, "_SHARED", name), (fault.where & faults::kShared) != 0)
        << fault.name << " in shared.patch";
  }
}

}  // namespace
}  // namespace kiloband::test
