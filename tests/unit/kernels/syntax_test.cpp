// The kernels are OpenCL C 1.2 for any device: compiled for spir64 with all warnings as errors, general and
// with each feature left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "scene/compile/scene_features.hpp"
#include "tests/support/effort.hpp"
#include "tests/support/opencl_syntax.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;

const fs::path kKernels = fs::path(KILOBAND_SOURCE_DIR) / "kernels";

std::vector<fs::path> kernel_files(const std::string& extension) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(kKernels)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  return files;
}

/// The features that kernels may be built without.
std::vector<std::string> all_features() {
#define KB_MACRO_NAME(macro, member, name) #macro,
  return {KB_SCENE_FEATURES(KB_MACRO_NAME)};
#undef KB_MACRO_NAME
}

TEST(KernelSyntax, EveryFeatureIsThereWhereNoneIsChosen) {
  std::ifstream file(kKernels / "base/scene.clh");
  const std::string prefix = "#define KB_HAS_";
  std::vector<std::string> features;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(prefix) && line.ends_with(" 1"))
      features.push_back(line.substr(prefix.size(), line.size() - prefix.size() - 2));
  }
  EXPECT_EQ(features, all_features());
}

TEST(KernelSyntax, EveryFileCompilesAlone) {
  std::size_t count = 0;
  for (const std::string extension : {".cl", ".clh"}) {
    for (const fs::path& file : kernel_files(extension)) {
      EXPECT_EQ(kernel_syntax(file), "") << file;
      ++count;
    }
  }
  EXPECT_GE(count, 40u);
}

/// The texts that a kernel file consists of, each once, but the one that gives features that nobody chose.
void add_texts(const fs::path& file, std::map<fs::path, std::string>& texts) {
  if (file == kKernels / "base/scene.clh" || texts.contains(file)) return;
  const std::string text = texts[file] = read_file(file);
  static const std::regex kInclude("#include \"(.*)\"");
  for (std::sregex_iterator found(text.begin(), text.end(), kInclude), end; found != end; ++found) {
    for (const fs::path& root : {kKernels, kKernels / "../src"})
      if (fs::exists(root / (*found)[1].str())) add_texts(root / (*found)[1].str(), texts);
  }
}

/// Whether a file's text depends on the feature: only then is it another one without.
bool depends_on(const std::map<fs::path, std::string>& texts, const std::string& feature) {
  const std::regex name("\\bKB_HAS_" + feature + "\\b");
  return std::ranges::any_of(texts, [&](const auto& text) { return std::regex_search(text.second, name); });
}

TEST(KernelSyntax, EveryFeatureCanBeAbsent) {
  const std::vector<std::string> features = all_features();
  ASSERT_GE(features.size(), 24u);
  const auto defines = [&](const std::string& present, const std::string& value, const std::string& others) {
    std::string text = "-DKB_SPECIALISED";
    for (const std::string& f : features) text += " -DKB_HAS_" + f + "=" + (f == present ? value : others);
    return text;
  };
  std::set<std::string> unused(features.begin(), features.end());
  for (const fs::path& file : kernel_files(".cl")) {
    EXPECT_EQ(kernel_syntax(file, defines("", "", "0")), "") << file << " without any";
    EXPECT_EQ(kernel_syntax(file, defines("", "", "1")), "") << file << " with all";
    std::map<fs::path, std::string> texts;
    add_texts(file, texts);
    for (const std::string& feature : features) {
      if (!depends_on(texts, feature)) continue;
      unused.erase(feature);
      if (thorough()) {  // scenes' own programs have few features, too
        EXPECT_EQ(kernel_syntax(file, defines(feature, "1", "0")), "")
            << file << " with " << feature << " alone";
      }
      EXPECT_EQ(kernel_syntax(file, defines(feature, "0", "1")), "") << file << " without " << feature;
    }
  }
  EXPECT_EQ(unused, std::set<std::string>{}) << "no kernel asks for it, or texts are missed";
}

TEST(KernelSyntax, TheMethodPtCompiles) {
  EXPECT_EQ(kernel_syntax(kKernels / "path/paths.cl", "-DKB_METHOD_PT=1"), "");
}

/// The check itself can fail.
TEST(KernelSyntax, MistakesAreFound) {
  const TemporaryFolder folder;
  const fs::path file =
      folder.write("mistake.cl", "__kernel void f(__global float* x) { x[0] = undeclared; }\n");
  EXPECT_NE(kernel_syntax(file).find("undeclared"), std::string::npos);
}

}  // namespace
}  // namespace kiloband::test
