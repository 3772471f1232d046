// Which way normals point in a flattened scene, and what a transform that mirrors does to them.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::front_test {
namespace {

const std::string kMirror = "<transform name='to_world'><scale x='-1'/></transform>";
const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

FlatScene flat(const std::string& type, const std::string& content, const std::string& file = "") {
  const TemporaryFolder folder;
  folder.write("mesh.obj", file);
  const std::string scene =
      "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/><shape type='" + type +
      "'>" + (file.empty() ? "" : "<string name='filename' value='mesh.obj'/>") + content +
      "</shape></scene>";
  const ChannelList channels = parse_channels("500-510");
  return *compile_scene(read_scene_text(scene, "scene.xml", folder.path()), {channels, channels, {}});
}

uint32_t front_flags(const FlatScene& scene) {
  return scene.shapes.at(0).flags & (KB_SHAPE_FLIP_NORMALS | KB_SHAPE_MIRRORED);
}

TEST(Front, MirroredMeshesKeepTheOrderOfTheirCorners) {
  const std::string normals = std::string(kTriangle) + "vn 0 0 1\nf 1//1 2//1 3//1\n";
  const std::string plain = std::string(kTriangle) + "f 1 2 3\n",
                    face = "<boolean name='face_normals' value='true'/>";
  EXPECT_EQ(front_flags(flat("obj", kMirror, normals)), KB_SHAPE_MIRRORED);
  EXPECT_EQ(front_flags(flat("obj", face + kMirror, normals)), 0u);
  EXPECT_EQ(front_flags(flat("obj", kMirror, plain)), 0u);
  EXPECT_EQ(front_flags(flat("obj", "", normals)), 0u);
  EXPECT_EQ(front_flags(flat("rectangle", kMirror)), KB_SHAPE_MIRRORED);
  EXPECT_EQ(front_flags(flat("cube", kMirror)), KB_SHAPE_MIRRORED);
  const std::vector<uint32_t> with_the_spare_one{0, 1, 2, 0};  // see FlatScene
  EXPECT_EQ(flat("obj", kMirror, normals).triangles, with_the_spare_one);
}

TEST(Front, MirroredSpheresTurnOver) {
  const std::string flipped = "<boolean name='flip_normals' value='true'/>";
  EXPECT_EQ(front_flags(flat("sphere", kMirror)), KB_SHAPE_FLIP_NORMALS);
  EXPECT_EQ(front_flags(flat("sphere", flipped + kMirror)), 0u);
  for (const char* type : {"disk", "cylinder"}) {
    EXPECT_EQ(front_flags(flat(type, kMirror)), 0u);
    EXPECT_EQ(front_flags(flat(type, flipped + kMirror)), KB_SHAPE_FLIP_NORMALS);
  }
}

/// Normals of the file go with the transform, computed ones with the triangles that it places.
TEST(Front, VertexNormalsUnderAMirror) {
  const FlatScene given = flat("obj", kMirror, std::string(kTriangle) + "vn 0.6 0 0.8\nf 1//1 2//1 3//1\n");
  EXPECT_NEAR(given.normals.at(0).x, -0.6, 1e-6);
  EXPECT_NEAR(given.normals.at(0).z, 0.8, 1e-6);
  EXPECT_EQ(flat("obj", kMirror, std::string(kTriangle) + "f 1 2 3\n").normals.at(0).z, -1);
  EXPECT_EQ(flat("obj", "", std::string(kTriangle) + "f 1 2 3\n").normals.at(0).z, 1);
}

}  // namespace
}  // namespace kiloband::test::front_test
