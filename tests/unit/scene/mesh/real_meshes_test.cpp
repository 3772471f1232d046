// Public meshes that others wrote, where this machine has them; without them these tests check nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>

#include "scene/mesh/mesh.hpp"
#include "support.hpp"
#include "tests/support/data_folder.hpp"

namespace kiloband::test {
namespace {

struct RealMeshes : testing::Test {
  TemporaryFolder folder;
  Messages messages;
  /// Path of a data file, empty if it is not there.
  static std::filesystem::path data(const std::string& name) {
    const std::filesystem::path file = data_folder() / name;
    return std::filesystem::exists(file) ? file : std::filesystem::path();
  }
  Mesh read(const std::filesystem::path& path, const MeshOptions& options = {}) {
    const auto sink = messages.lines(folder);
    if (path.extension() == ".ply") return read_ply(path, options, sink);
    if (path.extension() == ".serialized") return read_serialized(path, options, sink);
    return read_obj(path, options, sink);
  }
};

struct Expected {
  const char* file;
  size_t vertices, triangles;
};

// Counts: `grep -c` of the files' own lines; polygons with n corners make n - 2 triangles.
TEST_F(RealMeshes, HaveTheirCounts) {
  const std::vector<Expected> files = {{"meshes/conference.ply", 152612, 331179},
                                       {"meshes/dragon.obj", 50000, 100000},
                                       {"meshes/happy-buddha.obj", 49950, 100000},
                                       {"meshes/lucy_10k.ply", 5000, 9996},
                                       {"meshes/stanford-bunny.obj", 35947, 69451},
                                       {"meshes/f16.obj", 2537, 4428},
                                       {"meshes/suzanne.obj", 507, 968},
                                       {"loaders/obj/cbox_smallbox.obj", 24, 12},
                                       {"loaders/obj/rectangle_normals_uv.obj", 4, 2},
                                       {"loaders/ply/cbox_smallbox.ply", 24, 12},
                                       {"loaders/ply/rectangle_normals_uv.ply", 4, 2},
                                       {"loaders/ply/triangle_face_colors.ply", 3, 1},
                                       {"scenes/mitsuba/cbox/meshes/cbox_back.obj", 4, 2},
                                       {"scenes/veach_mi/floor.obj", 12, 4}};
  for (const Expected& expected : files) {
    const auto path = data(expected.file);
    if (path.empty()) continue;
    const Mesh mesh = read(path);
    EXPECT_LE(mesh.positions.size(), expected.vertices)
        << expected.file;  // OBJ: what no face uses is not kept
    EXPECT_EQ(mesh.triangles.size(), expected.triangles) << expected.file;
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << expected.file;
  }
}

TEST_F(RealMeshes, EveryFileLoads) {
  if (data_folder().empty()) return;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder())) {
    const auto extension = entry.path().extension();
    if (extension != ".obj" && extension != ".ply") continue;
    EXPECT_NO_THROW(read(entry.path())) << entry.path();
  }
}

TEST_F(RealMeshes, ConferenceHasManyFlatTriangles) {
  const auto path = data("meshes/conference.ply");
  if (path.empty()) return;
  const Mesh mesh = read(path);
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_TRUE(messages.texts[0].ends_with(": warning: 53627 of 331179 triangles have zero area"))
      << messages.texts[0];
  // 52,670 of them use a vertex twice, 957 have three different ones on a line.
  const auto repeats = [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
  EXPECT_EQ(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), repeats), 52670);
}

// The three meshes of the serialized file were also converted to PLY by another program.
TEST_F(RealMeshes, SerializedEqualsPly) {
  const auto path = data("scenes/mitsuba/matpreview/matpreview.serialized");
  if (path.empty()) return;
  for (int i = 0; i < 3; ++i) {
    MeshOptions options;
    options.shape_index = i;
    const Mesh serialized = read(path, options);
    const auto other = data("scenes/mitsuba/matpreview/ply/shape_0" + std::to_string(i) + ".ply");
    if (other.empty()) continue;
    const Mesh ply = read(other);
    EXPECT_EQ(serialized.positions, ply.positions) << i;
    EXPECT_EQ(serialized.triangles, ply.triangles) << i;
    EXPECT_EQ(serialized.normals, ply.normals) << i;
    EXPECT_EQ(serialized.uvs, ply.uvs) << i;
  }
}

// A hundred thousand triangles of text: well under a tenth of a second; the bound leaves room for sanitizers
// and busy machines.
TEST_F(RealMeshes, LargeTextsAreFast) {
  const auto path = data("meshes/dragon.obj");
  if (path.empty()) return;
  const std::clock_t start = std::clock();
  read(path);
  EXPECT_LT(cpu_seconds_since(start), 5.0);
}

}  // namespace
}  // namespace kiloband::test
