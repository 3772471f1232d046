// Dependencies point one way: the table "Code map" of ARCHITECTURE.md, enforced on the #include lines.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "tests/unit/structure/source_tree.hpp"

namespace kiloband::test {
namespace {

/// What the files of a folder may include besides those of the folder itself. src/app sees everything.
const std::map<std::string, std::set<std::string>> kAllowed{
    {"src/base", {}},
    {"src/shared", {}},
    {"src/stats", {"src/base"}},
    {"src/spectral", {"src/base", "src/shared"}},
    {"src/scene", {"src/base", "src/shared", "src/spectral", "src/film"}},
    {"src/sky", {"src/base", "src/spectral"}},
    {"src/film", {"src/base", "src/shared", "src/spectral"}},
    {"src/render", {"src/base", "src/shared", "src/spectral", "src/scene", "src/film"}},
    {"src_cpu", {"src/base", "src/shared", "src/spectral", "src/scene", "src/film", "src/render"}},
    {"src_gpu", {"src/base", "src/shared", "src/spectral", "src/scene", "src/film", "src/render"}},
    {"kernels", {"src/shared"}},
    {"scenes", {}},
    {"src/app",
     {"src/base", "src/shared", "src/spectral", "src/scene", "src/sky", "src/film", "src/render", "src/stats",
      "src_cpu", "src_gpu", "scenes", "validation"}},
};

/// "src/film" of "src/film/png.cpp", "src_cpu" of "src_cpu/isa.cpp".
std::string part_of(const std::string& path) {
  const auto first = path.find('/');
  const std::string top = path.substr(0, first);
  if (top != "src" || first == std::string::npos) return top;
  return path.substr(0, path.find('/', first + 1));
}

/// Includes are rooted at src/ or at the project, those of kernels also at kernels/; a plain name stands
/// beside the file.
std::string resolve(const SourceFile& file, const std::string& include) {
  namespace fs = std::filesystem;
  const std::string beside = (fs::path(file.path).parent_path() / include).lexically_normal().string();
  for (const std::string& path : {"src/" + include, include, beside}) {
    if (fs::is_regular_file(fs::path(KILOBAND_SOURCE_DIR) / path)) return path;
  }
  return "";
}

TEST(Dependencies, IncludesFollowTheTable) {
  std::size_t count = 0;
  for (const SourceFile& file : read_files({"src", "src_cpu", "src_gpu", "kernels", "scenes/generator"})) {
    const std::string part = part_of(file.path);
    ASSERT_TRUE(kAllowed.contains(part)) << file.path << ": a folder that the table does not know";
    for (const auto& [line, include] : own_includes(file.text)) {
      ++count;
      const std::string target = resolve(file, include);
      ASSERT_NE(target, "") << file.path << ":" << line << ": \"" << include << "\" is not found";
      const std::string other = part_of(target);
      EXPECT_TRUE(other == part || kAllowed.at(part).contains(other))
          << file.path << ":" << line << ": " << part << " must not include " << other;
    }
  }
  EXPECT_GT(count, 300u) << "the scan of #include lines has lost its way";
}

/// Spectral images are cubes: one file of src/scene reads them, by the interface of cubes alone.
TEST(Dependencies, TheSceneSeesCubesThroughOneFile) {
  std::vector<std::string> users;
  for (const SourceFile& file : read_files({"src/scene"})) {
    for (const auto& [line, include] : own_includes(file.text)) {
      if (part_of(resolve(file, include)) == "src/film") users.push_back(file.path + " " + include);
    }
  }
  EXPECT_EQ(users, std::vector<std::string>{"src/scene/spectral_image.cpp film/cube_io.hpp"});
}

/// Only the backends see Embree (the OpenCL one for its builder alone) and OpenCL; images stay behind the
/// image loading interface and the cube files.
TEST(Dependencies, LibrariesStayBehindTheirInterfaces) {
  for (const SourceFile& file : read_files({"src", "src_cpu", "src_gpu"})) {
    if (part_of(file.path) != "src_cpu" && part_of(file.path) != "src_gpu") {
      EXPECT_EQ(file.text.find("<embree"), std::string::npos) << file.path;
    }
    if (part_of(file.path) != "src_gpu") {
      EXPECT_EQ(file.text.find("<CL/"), std::string::npos) << file.path;
    }
    if (file.path.ends_with(".hpp") || file.path.ends_with(".h")) {
      EXPECT_EQ(file.text.find("<OpenImageIO"), std::string::npos) << file.path;
    }
  }
}

/// src/shared is C++ and OpenCL C: which of them is decided in lang.h alone, and nothing of the standard
/// library is used.
TEST(Dependencies, SharedHeadersLeaveTheLanguageToLang) {
  std::size_t headers = 0;
  for (const SourceFile& file : read_files({"src/shared"})) {
    if (!file.path.ends_with(".h") || file.path == "src/shared/lang.h") continue;
    ++headers;
    for (const char* test : {"__cplusplus", "__OPENCL", "#include <"}) {
      EXPECT_EQ(file.text.find(test), std::string::npos) << file.path << " has " << test;
    }
  }
  EXPECT_GE(headers, 10u);
}

}  // namespace
}  // namespace kiloband::test
