// Rules for all files of the project: their length, and what they must not contain.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

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

/// Paths of the machine on which somebody works: home folders and the folder that holds this checkout.
TEST(Tree, NoPathsOfOneMachine) {
  std::vector<std::string> forbidden{std::string("/ho") + "me/", std::string("/ro") + "ot/",
                                     std::string("/Us") + "ers/"};
  const std::string parent = std::filesystem::path(KILOBAND_SOURCE_DIR).parent_path().string() + "/";
  if (parent.size() > 2) forbidden.push_back(parent);
  for (const SourceFile& file : all_files()) {
    for (const std::string& path : forbidden) {
      EXPECT_EQ(file.text.find(path), std::string::npos) << file.path << " has " << path;
    }
  }
}

}  // namespace
}  // namespace kiloband::test
