// What the patches plant compiles: every kernel, and every C++ file that they change, with this build's flags. Nothing
// else in a build without faults would notice that a name which a fault uses has gone.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/effort.hpp"
#include "tests/unit/validation/faults/shell.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = KILOBAND_SOURCE_DIR;

class PatchedCode : public testing::Test {
 protected:
  PatchedCode() {
    const Said said =
        run_shell("'" + (kRoot / "scripts/plant_faults.sh").string() + "' '" + folder_.path().string() + "'");
    if (said.code != 0) throw std::runtime_error(said.text);
  }
  fs::path tree() const { return folder_ / "tree"; }

 private:
  TemporaryFolder folder_;
};

TEST_F(PatchedCode, KernelsCompile) {
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(tree() / "kernels")) {
    if (entry.path().extension() != ".cl") continue;
    ++count;
    const std::string folder = tree().string();
    const Said said =
        run_shell(KILOBAND_CLANG
                  " -x cl -cl-std=CL1.2 -target spir64 -Xclang -finclude-default-header -Wall -Wextra -Werror"
                  " -Wno-unused-function -Wno-unused-parameter -fsyntax-only -DKB_PLANTED_SELECTED=1 '-I" +
                  folder + "/kernels' '-I" + folder + "/src' '" + entry.path().string() + "'");
    EXPECT_EQ(said.code, 0) << said.text;
  }
  EXPECT_GE(count, 5u);
}

/// C++ files, "src_cpu/path/camera.cpp"; for a header of the CPU backend those of its folder.
std::set<std::string> patched_sources() {
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(kRoot / "validation/faults/patches")) {
    std::ifstream patch(entry.path());
    for (std::string line; std::getline(patch, line);) {
      if (line.starts_with("+++ b/") && line.ends_with(".cpp")) files.insert(line.substr(6));
      if (!line.starts_with("+++ b/") || !line.ends_with(".hpp")) continue;
      const fs::path folder = fs::path(line.substr(6)).parent_path();
      for (const auto& beside : fs::directory_iterator(kRoot / folder)) {
        if (beside.path().extension() == ".cpp") files.insert((folder / beside.path().filename()).string());
      }
    }
  }
  return files;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// The files that a file of KILOBAND_UNITY includes; of others, itself.
std::vector<std::string> files_of(const std::string& source) {
  if (source.find("/Unity/unity_") == std::string::npos) return {source};
  static const std::regex kInclude("#include \"(.*)\"");
  std::vector<std::string> files;
  std::ifstream file(source);
  std::smatch match;
  for (std::string line; std::getline(file, line);)
    if (std::regex_match(line, match, kInclude)) files.push_back(match[1]);
  return files;
}

/// How this build compiles a file of the project, by its path; without precompiled headers, which are of this tree.
std::map<std::string, std::string> compile_commands() {
  static const std::regex kPrecompiled("-Winvalid-pch|-include [^ ]*cmake_pch[^ ]*");
  std::ifstream file(fs::path(KILOBAND_BINARY_DIR) / "compile_commands.json");
  std::map<std::string, std::string> commands;
  for (const nlohmann::json& entry : nlohmann::json::parse(file)) {
    const std::string source = entry.at("file").get<std::string>();
    const std::string command = std::regex_replace(entry.at("command").get<std::string>(), kPrecompiled, "");
    for (const std::string& single : files_of(source))
      commands.emplace(single, replaced(command, source, single));
  }
  return commands;
}

/// Files that are compiled with the same flags: `command` has FILE for their path and writes nothing.
struct Unit {
  std::string command;
  std::vector<std::string> files;
};

/// Files of a folder are compiled together: names in a library's anonymous namespaces differ, and headers are read once.
/// Those that are compiled once per instruction set include themselves and stay alone; one set shows what does not compile.
std::vector<Unit> units_of(const std::set<std::string>& files) {
  static const std::regex kObject(" -o [^ ]*");
  const std::map<std::string, std::string> commands = compile_commands();
  std::map<std::pair<std::string, fs::path>, std::vector<std::string>> together;
  std::vector<Unit> units;
  for (const std::string& file : files) {
    const std::string path = (kRoot / file).string();
    const auto found = commands.find(path);
    if (found == commands.end()) throw std::runtime_error(file + " is not built");
    const std::string command = std::regex_replace(replaced(found->second, path, "FILE"), kObject, "") +
                                " -fsyntax-only -DKILOBAND_FAULTS";
    if (read_file(path).find("hwy/foreach_target.h") != std::string::npos)
      units.push_back({command + " -DKILOBAND_NATIVE", {file}});
    else
      together[{command, fs::path(file).parent_path()}].push_back(file);
  }
  for (const auto& [key, those] : together) units.push_back({key.first, those});
  return units;
}

Said compile(const Unit& unit, const fs::path& tree) {
  fs::path file = tree / unit.files[0];
  if (unit.files.size() > 1) {
    file = tree / "together.cpp";
    std::ofstream text(file);
    for (const std::string& one : unit.files) text << "#include \"" << one << "\"\n";
  }
  return run_shell(replaced(replaced(unit.command, kRoot.string(), tree.string()), "FILE", file.string()));
}

/// In batches, so that ctest runs them side by side; each takes every kBatches-th unit.
class PatchedSources : public PatchedCode, public testing::WithParamInterface<std::size_t> {};
constexpr std::size_t kBatches = 4;

TEST_P(PatchedSources, Compile) {
  if (!thorough())
    GTEST_SKIP()
        << "a minute and a half of compiling: with KILOBAND_THOROUGH, and by scripts/build_faults.sh";
  const std::set<std::string> files = patched_sources();
  EXPECT_GE(files.size(), 20u) << "the scan of the patches has lost its way";
  const std::vector<Unit> units = units_of(files);
  EXPECT_GE(units.size(), kBatches);
  for (std::size_t i = GetParam(); i < units.size(); i += kBatches) {
    const Said said = compile(units[i], tree());
    EXPECT_EQ(said.code, 0) << testing::PrintToString(units[i].files) << "\n" << said.text;
  }
}
INSTANTIATE_TEST_SUITE_P(, PatchedSources, testing::Range<std::size_t>(0, kBatches));

TEST_F(PatchedCode, TheCheckItselfCanFail) {
  const std::string broken = "src_cpu/path/camera.cpp";
  std::ofstream(tree() / broken, std::ios::app) << "int mistake() { return KB_PLANTED(NO_SUCH_FAULT); }\n";
  const Said said = compile(units_of({broken}).at(0), tree());
  EXPECT_NE(said.text.find("KB_PLANTED_NO_SUCH_FAULT"), std::string::npos) << said.text;
}

}  // namespace
}  // namespace kiloband::test
