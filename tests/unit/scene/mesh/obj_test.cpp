// OBJ files that are right.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/mesh/mesh.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

const std::string kQuadPositions = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

struct Obj : testing::Test {
  TemporaryFolder folder;
  Messages messages;
  Mesh read(const std::string& text, const MeshOptions& options = {}) {
    return read_obj(folder.write("a.obj", text), options, messages.lines(folder));
  }
};

TEST_F(Obj, FansPolygons) {
  const Mesh mesh = read("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n");
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_TRUE(mesh.uvs.empty());
}

TEST_F(Obj, MayBeginWithAByteOrderMark) {
  EXPECT_EQ(read("\xEF\xBB\xBF" + kQuadPositions + "f 1 2 3\n").triangles.size(), 1u);
}

TEST_F(Obj, ReadsEveryKindOfCorner) {
  const std::string head = kQuadPositions + "vt 0.25 0.75\nvn 0 0 -2\n";
  EXPECT_EQ(read(head + "f 1 2 3\n").normals[0], (Vec3f{0, 0, 1}));  // computed: vn is not referred to
  EXPECT_TRUE(read(head + "f 1 2 3\n").uvs.empty());
  EXPECT_EQ(read(head + "f 1/1 2/1 3/1\n").uvs, (std::vector<Vec2f>(3, {0.25f, 0.75f})));
  EXPECT_EQ(read(head + "f 1//1 2//1 3//1\n").normals, (std::vector<Vec3f>(3, {0, 0, -1})));
  EXPECT_EQ(read(head + "f 1/1/ 2/1/ 3/1/\n").uvs, (std::vector<Vec2f>(3, {0.25f, 0.75f})));
  const Mesh full = read(head + "f 1/1/1 2/1/1 3/1/1\n");
  EXPECT_EQ(full.normals.size(), 3u);
  EXPECT_EQ(full.uvs.size(), 3u);
}

TEST_F(Obj, FlipsTextureCoordinatesOnRequest) {
  MeshOptions options;
  options.flip_tex_coords = true;
  EXPECT_EQ(read(kQuadPositions + "vt 0.25 0.75\nf 1/1 2/1 3/1\n", options).uvs[0], (Vec2f{0.25f, 0.25f}));
}

TEST_F(Obj, VertexIsAnIndexTuple) {
  // Two triangles share positions 1 and 3, but only corner 1/1 is the same tuple in both.
  const Mesh mesh = read(kQuadPositions + "vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/1 3/2 4/1\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 3, 4}}));
  EXPECT_EQ(mesh.positions[2], mesh.positions[3]);
}

TEST_F(Obj, SmoothsOverIndicesNotOverEqualPositions) {
  // A right-angled roof, once with a shared ridge and once with the ridge's positions written twice.
  const std::string shared = "v 0 0 1\nv 0 1 1\nv 1 0 0\nv -1 0 0\nf 1 3 2\nf 2 4 1\n";
  const std::string doubled = "v 0 0 1\nv 0 1 1\nv 1 0 0\nv -1 0 0\nv 0 0 1\nv 0 1 1\nf 1 3 2\nf 6 4 5\n";
  const Vec3f smooth = read(shared).normals[0];
  EXPECT_NEAR(smooth[0], 0, 1e-6);
  EXPECT_NEAR(smooth[2], 1, 1e-6);
  for (const Vec3f& normal : read(doubled).normals) EXPECT_NEAR(std::abs(normal[0]), std::sqrt(0.5), 1e-6);
}

TEST_F(Obj, FaceNormalsDropVertexNormals) {
  MeshOptions options;
  options.face_normals = true;
  EXPECT_TRUE(read(kQuadPositions + "vn 0 0 1\nf 1//1 2//1 3//1\n", options).normals.empty());
}

TEST_F(Obj, IgnoresDocumentedLinesAndExtraNumbers) {
  const Mesh mesh = read(
      "# comment\nmtllib a.mtl\no thing\ng group one\ns 1\nusemtl red\r\n\n  v 0 0 0 1\r\nv\t1 0 0 0.5 0.5 "
      "0.5\n"
      "v +1.5e0 .5 -0. # \nvt 0 1 0\nl 1 2\np 1\nf 1 2 3");
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.positions[2], (Vec3f{1.5f, 0.5f, 0}));
  EXPECT_TRUE(messages.texts.empty());
}

TEST_F(Obj, SeveralMaterialsAreNoted) {
  read("mtllib a.mtl\n" + kQuadPositions +
       "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl red\nf 2 3 4\n");
  EXPECT_EQ(messages.texts,
            (std::vector<std::string>{
                "a.obj: note: 2 materials (usemtl) are ignored: the shape has one bsdf for all"}));
}

TEST_F(Obj, TinyNumbersUnderflowToZero) {
  EXPECT_EQ(read("v 1e-60 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").positions[0], (Vec3f{}));
}

TEST_F(Obj, WarnsOfZeroAreaOnce) {
  read(kQuadPositions + "f 1 2 3\nf 1 1 2\nf 1 2 2\n");
  EXPECT_EQ(messages.texts, (std::vector<std::string>{"a.obj: warning: 2 of 3 triangles have zero area"}));
}

TEST_F(Obj, FillsWhatSomeCornersLack) {
  const Mesh mesh = read(kQuadPositions + "vt 0.5 0.5\nvn 1 0 0\nf 1/1/1 2 3\n");
  EXPECT_EQ(mesh.normals, (std::vector<Vec3f>{{1, 0, 0}, {0, 0, 1}, {0, 0, 1}}));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2f>{{0.5f, 0.5f}, {0, 0}, {0, 0}}));
  EXPECT_EQ(messages.texts,
            (std::vector<std::string>{
                "a.obj: warning: 2 of 3 vertices have no texture coordinates: (0, 0) is used",
                "a.obj: warning: 2 of 3 vertex normals are missing or zero: computed from the triangles"}));
}

TEST_F(Obj, ManyTuplesAtOnePositionStayFast) {
  // A chain of tuples per position would need 10^10 / 2 steps here.
  std::string text = kQuadPositions;
  for (int i = 0; i < 100000; ++i) text += "vt 0 0\n";
  text += "f 2/1 3/1";
  for (int i = 1; i <= 100000; ++i) text += " 1/" + std::to_string(i);
  EXPECT_EQ(read(text + "\n").positions.size(), 100002u);
}

}  // namespace
}  // namespace kiloband::test
