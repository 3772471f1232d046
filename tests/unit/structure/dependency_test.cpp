// Dependencies point one way: the map of rooms in ARCHITECTURE.md, enforced on the #include lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "tests/unit/structure/source_tree.hpp"

namespace kiloband::test {
namespace {

/// What the files of a room may include besides their own; an entry "src_cpu/" stands for all rooms below. The rooms of a
/// folder are named from the ground up: none includes one that stands behind it.
const std::vector<std::pair<std::string, std::set<std::string>>> kRooms{
    {"src/base", {}},
    {"src/shared", {}},
    {"src/stats", {"src/base"}},
    {"src/spectral", {"src/base"}},
    {"src/sky", {"src/base", "src/spectral"}},
    {"src/files", {"src/base"}},
    {"src/pictures", {"src/base"}},
    {"src/cube", {"src/base", "src/files", "src/spectral"}},
    {"src/film", {"src/base", "src/shared", "src/files"}},
    {"src/scene/mesh", {"src/base"}},
    {"src/scene/image", {"src/base", "src/spectral", "src/pictures", "src/cube"}},
    {"src/scene/description",
     {"src/base", "src/shared", "src/spectral", "src/scene/mesh", "src/scene/image"}},
    {"src/scene/xml", {"src/base", "src/spectral"}},
    {"src/scene/read",
     {"src/base", "src/spectral", "src/sky", "src/scene/mesh", "src/scene/description", "src/scene/xml"}},
    {"src/scene/optics", {"src/base", "src/shared", "src/spectral"}},
    {"src/scene/compile",
     {"src/base", "src/shared", "src/spectral", "src/film", "src/scene/description", "src/scene/read",
      "src/scene/optics"}},
    {"src/post", {"src/spectral", "src/files", "src/pictures", "src/cube", "src/film"}},
    {"src/render",
     {"src/base", "src/shared", "src/spectral", "src/files", "src/cube", "src/film", "src/post",
      "src/scene/description", "src/scene/compile"}},
    {"src/viewer",
     {"src/base", "src/spectral", "src/files", "src/cube", "src/film", "src/post", "src/scene/description",
      "src/scene/read", "src/render"}},
    {"kernels/base", {"src/shared"}},
    {"kernels/geometry", {"src/shared", "kernels/base"}},
    {"kernels/bsdf", {"src/shared", "kernels/base"}},
    {"kernels/light", {"src/shared", "kernels/base", "kernels/geometry"}},
    {"kernels/path", {"src/shared", "kernels/base", "kernels/geometry", "kernels/bsdf", "kernels/light"}},
    {"kernels/film", {"src/shared", "kernels/base"}},
    {"kernels/evaluate", {"src/shared", "kernels/base", "kernels/film"}},
    {"src_cpu/lanes", {"src/"}},
    {"src_cpu/geometry", {"src/", "src_cpu/lanes"}},
    {"src_cpu/bsdf", {"src/", "src_cpu/lanes"}},
    {"src_cpu/light", {"src/", "src_cpu/lanes", "src_cpu/geometry", "src_cpu/bsdf"}},
    {"src_cpu/path", {"src/", "src_cpu/lanes", "src_cpu/geometry", "src_cpu/bsdf", "src_cpu/light"}},
    {"src_cpu/evaluate", {"src/", "src_cpu/lanes", "src_cpu/geometry", "src_cpu/path"}},
    {"src_cpu", {"src/", "src_cpu/"}},
    {"src_gpu/device", {"src/"}},
    {"src_gpu/geometry", {"src/"}},
    {"src_gpu/scene", {"src/", "src_gpu/device", "src_gpu/geometry"}},
    {"src_gpu/path", {"src/", "src_gpu/device", "src_gpu/scene"}},
    {"src_gpu/evaluate", {"src/", "src_gpu/device", "src_gpu/scene", "src_gpu/path"}},
    {"src_gpu", {"src/", "src_gpu/"}},
    {"scenes/generator", {}},
    {"validation/oracle", {"src/", "src_cpu/path"}},
    {"validation", {"src/", "src_cpu", "src_cpu/", "src_gpu", "src_gpu/", "validation/oracle"}},
    {"validation/bench",
     {"src/", "kernels/geometry", "src_cpu", "src_cpu/", "src_gpu", "src_gpu/", "validation", "tests/support",
      "tests/unit/src_cpu/evaluate", "tests/unit/src_gpu/evaluate"}},
    {"validation/stats", {"src/", "tests/support"}},
    {"app", {"src/", "src_cpu", "src_gpu", "src_gpu/", "scenes/generator", "validation"}},
};

/// "src/scene/read" of "src/scene/read/ior.cpp". A folder that the table does not name is part of the room that
/// it stands in: src/spectral/files of src/spectral.
std::string room_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (std::filesystem::path room = folder; !room.empty(); room = room.parent_path()) {
    if (std::ranges::any_of(kRooms, [&](const auto& entry) { return entry.first == room.string(); }))
      return room.string();
  }
  return folder.string();
}

bool is_source(const std::string& path) {
  static const std::set<std::string> kExtensions{".cpp", ".hpp", ".h", ".cl", ".clh"};
  return kExtensions.contains(std::filesystem::path(path).extension().string());
}

bool may_include(const std::set<std::string>& allowed, const std::string& room) {
  return std::ranges::any_of(allowed, [&](const std::string& entry) {
    return entry.ends_with('/') ? starts_with(room, entry) : room == entry;
  });
}

/// Includes are rooted at src/ or at the project, those of kernels also at kernels/; a plain name stands
/// beside the file.
std::string resolve(const SourceFile& file, const std::string& include) {
  namespace fs = std::filesystem;
  const std::string beside = (fs::path(file.path).parent_path() / include).lexically_normal().string();
  for (const std::string& path : {"src/" + include, include, "kernels/" + include, beside}) {
    if (fs::is_regular_file(fs::path(KILOBAND_SOURCE_DIR) / path)) return path;
  }
  return "";
}

TEST(Dependencies, IncludesFollowTheTable) {
  const std::map<std::string, std::set<std::string>> rooms(kRooms.begin(), kRooms.end());
  std::size_t count = 0;
  for (const SourceFile& file :
       read_files({"src", "src_cpu", "src_gpu", "kernels", "app", "scenes/generator", "validation"})) {
    // Faults include what is there in the copy that has them.
    if (!is_source(file.path) || starts_with(file.path, "validation/faults/")) continue;
    const std::string room = room_of(file.path);
    ASSERT_TRUE(rooms.contains(room)) << file.path << ": a room that the table does not know";
    for (const auto& [line, include] : own_includes(file.text)) {
      ++count;
      const std::string target = resolve(file, include);
      ASSERT_NE(target, "") << file.path << ":" << line << ": \"" << include << "\" is not found";
      const std::string other = room_of(target);
      EXPECT_TRUE(other == room || may_include(rooms.at(room), other))
          << file.path << ":" << line << ": " << room << " must not include " << other;
    }
  }
  EXPECT_GT(count, 300u) << "the scan of #include lines has lost its way";
}

/// No circle of rooms: a room names only rooms that stand before it in the table.
TEST(Dependencies, ArrowsPointDown) {
  for (std::size_t i = 0; i < kRooms.size(); ++i) {
    for (std::size_t j = i + 1; j < kRooms.size(); ++j) {
      EXPECT_FALSE(may_include(kRooms[i].second, kRooms[j].first))
          << kRooms[i].first << " sees " << kRooms[j].first;
    }
  }
}

/// Spectral images are cubes: one file of src/scene reads them, by the interface of cubes alone.
TEST(Dependencies, TheSceneSeesCubesThroughOneFile) {
  std::vector<std::string> users;
  for (const SourceFile& file : read_files({"src/scene"})) {
    for (const auto& [line, include] : own_includes(file.text)) {
      if (room_of(resolve(file, include)) == "src/cube") users.push_back(file.path + " " + include);
    }
  }
  EXPECT_EQ(users, std::vector<std::string>{"src/scene/image/spectral_image.cpp cube/cube_io.hpp"});
}

/// Only the backends see Embree (the OpenCL one for its builder alone) and OpenCL; images stay behind the
/// image loading interface and the cube files.
TEST(Dependencies, LibrariesStayBehindTheirInterfaces) {
  for (const SourceFile& file : read_files({"src", "src_cpu", "src_gpu", "app"})) {
    if (!starts_with(file.path, "src_cpu/") && !starts_with(file.path, "src_gpu/")) {
      EXPECT_EQ(file.text.find("<embree"), std::string::npos) << file.path;
    }
    if (!starts_with(file.path, "src_gpu/")) {
      EXPECT_EQ(file.text.find("<CL/"), std::string::npos) << file.path;
    }
    if (file.path != "src/pictures/oiio_module.cpp") {
      EXPECT_EQ(file.text.find("<OpenImageIO"), std::string::npos) << file.path;
    }
    if (!starts_with(file.path, "src/pictures/")) {
      for (const char* header : {"<png.h>", "<jpeglib.h>"})
        EXPECT_EQ(file.text.find(header), std::string::npos) << file.path << " " << header;
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
