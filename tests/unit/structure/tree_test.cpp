// Rules for all files of the project: their length, and what they must not contain.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/unit/structure/source_tree.hpp"

namespace kiloband::test {
namespace {

constexpr std::ptrdiff_t kMaxLines = 400;

/// Numbers from published sources; their length is not ours to choose.
bool is_table(const std::string& path) {
  return path.find("_table") != std::string::npos && path.ends_with(".h");
}

TEST(Tree, FilesStayShort) {
  for (const SourceFile& file :
       read_files({"src", "src_cpu", "src_gpu", "kernels", "app", "scenes/generator", "tests"})) {
    if (is_table(file.path)) continue;
    EXPECT_LE(std::count(file.text.begin(), file.text.end(), '\n'), kMaxLines) << file.path;
  }
}

/// A room is read as a whole: what it holds is seen at a glance. Folders within it are rooms of their own.
TEST(Tree, RoomsStaySmall) {
  constexpr std::size_t kMaxFiles = 25;
  static const std::set<std::string> kCode{".cpp", ".hpp", ".h", ".cl", ".clh", ".py", ".js"};
  std::map<std::string, std::set<std::string>> rooms;
  for (const SourceFile& file :
       read_files({"src", "src_cpu", "src_gpu", "kernels", "app", "scenes", "tests", "validation"})) {
    const std::filesystem::path path = file.path;
    if (kCode.contains(path.extension().string())) rooms[path.parent_path().string()].insert(file.path);
  }
  for (const auto& [room, files] : rooms) EXPECT_LE(files.size(), kMaxFiles) << room;
  EXPECT_GT(rooms.size(), 80u) << "the scan of rooms has lost its way";
}

std::vector<SourceFile> all_files() {
  return read_files({"src", "src_cpu", "src_gpu", "kernels", "app", "tests", "validation", "docs", "scripts",
                     "cmake", "scenes", "CMakeLists.txt", "CMakePresets.json", "README.md", "ARCHITECTURE.md",
                     "CONTRIBUTING.md", ".ci/run"});
}

/// Written in two parts, so that this file is not a hit itself.
TEST(Tree, NothingIsLeftForLater) {
  for (const SourceFile& file : all_files()) {
    if (file.path.ends_with(".png")) continue;
    for (const std::string& word :
         {std::string("TO") + "DO", std::string("FIX") + "ME", std::string("XX") + "X"}) {
      EXPECT_EQ(file.text.find(word), std::string::npos) << file.path << " has " << word;
    }
  }
}

/// Paths of the machine on which somebody works: home folders, the folder that holds this checkout and, in what programs write
/// (pictures tell by which command they were made), scratch folders.
TEST(Tree, NoPathsOfOneMachine) {
  std::vector<std::string> forbidden{std::string("/ho") + "me/", std::string("/ro") + "ot/",
                                     std::string("/Us") + "ers/"};
  const std::string parent = std::filesystem::path(KILOBAND_SOURCE_DIR).parent_path().string() + "/";
  if (parent.size() > 2) forbidden.push_back(parent);
  for (const SourceFile& file : all_files()) {
    for (const std::string& path : forbidden) {
      EXPECT_EQ(file.text.find(path), std::string::npos) << file.path << " has " << path;
    }
    const bool code =
        file.path.ends_with(".cpp") || file.path.ends_with(".hpp") || file.path.ends_with(".sh");
    if (!code) {
      EXPECT_EQ(file.text.find(std::string("/t") + "mp/"), std::string::npos) << file.path;
    }
  }
}

/// Namespaces and names of the types that a file defines outside functions, classes and unnamed namespaces.
std::vector<std::string> types_of(const SourceFile& file) {
  static const std::regex kNamespace(R"(^namespace ([\w:]*) ?\{.*)");
  static const std::regex kType(
      R"(^(?:enum class|enum|class|struct) (?:alignas\(\d+\) )?(\w+)(?: final)?(?: :[^:].*)? \{.*)");
  std::vector<std::string> spaces, types;
  std::istringstream lines(file.text);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, match, kNamespace)) {
      spaces.push_back(match[1]);
    } else if (starts_with(line, "}  // namespace") && !spaces.empty()) {
      spaces.pop_back();
    } else if (std::regex_match(line, match, kType) && std::ranges::find(spaces, "") == spaces.end()) {
      std::string name;
      for (const std::string& space : spaces) name += space + "::";
      types.push_back(name + match[1].str());
    }
  }
  return types;
}

/// Two types of one name in one namespace are one to the linker, whichever of their functions it takes.
TEST(Tree, ATypeIsDefinedOnce) {
  std::map<std::string, std::string> places;
  for (const SourceFile& file : read_files({"src", "src_cpu", "src_gpu", "app", "validation"})) {
    if (!file.path.ends_with(".hpp") && !file.path.ends_with(".cpp")) continue;
    for (const std::string& type : types_of(file)) {
      const auto [place, is_new] = places.emplace(type, file.path);
      EXPECT_TRUE(is_new) << type << " is defined in " << place->second << " and in " << file.path;
    }
  }
  EXPECT_GT(places.size(), 300u) << "the scan of types has lost its way";
}

}  // namespace
}  // namespace kiloband::test
