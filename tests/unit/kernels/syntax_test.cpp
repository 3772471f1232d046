// The kernels are OpenCL C 1.2 for any device: compiled for spir64 with all warnings as errors, general and
// with each feature left out.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/compile/scene_features.hpp"
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

TEST(KernelSyntax, EveryFeatureCanBeAbsent) {
  const std::vector<std::string> features = all_features();
  ASSERT_GE(features.size(), 24u);
  const auto defines = [&](const std::string& present, const std::string& value, const std::string& others) {
    std::string text = "-DKB_SPECIALISED";
    for (const std::string& f : features) text += " -DKB_HAS_" + f + "=" + (f == present ? value : others);
    return text;
  };
  for (const fs::path& file : kernel_files(".cl")) {
    for (const std::string& feature : features) {
      EXPECT_EQ(kernel_syntax(file, defines(feature, "1", "0")), "")
          << file << " with " << feature << " alone";
      EXPECT_EQ(kernel_syntax(file, defines(feature, "0", "1")), "") << file << " without " << feature;
    }
  }
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
