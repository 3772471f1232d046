// PLY files that are right: the same quad in every encoding and with every scalar type.
#include <gtest/gtest.h>

#include "binary.hpp"
#include "scene/mesh/mesh.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

const Triangles kQuad = {{0, 1, 2}, {0, 2, 3}};

struct Ply : testing::Test {
  TemporaryFolder folder;
  Messages messages;
  Mesh read(const std::string& bytes, const MeshOptions& options = {}) {
    return read_ply(folder.write("a.ply", bytes), options, messages.lines(folder));
  }
};

std::string vertex_header(const std::string& format, const std::string& properties = "") {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + properties;
}

const std::string kFaceHeader = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST_F(Ply, ReadsText) {
  const Mesh mesh = read(vertex_header("ascii") + kFaceHeader + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  EXPECT_EQ(mesh.triangles, kQuad);
  EXPECT_EQ(mesh.positions[2], (Vec3f{1, 1, 0}));
  EXPECT_EQ(mesh.normals, (std::vector<Vec3f>(4, {0, 0, 1})));
  EXPECT_TRUE(mesh.vertex_attributes.empty());
  EXPECT_TRUE(messages.texts.empty());
}

TEST_F(Ply, TextMayBreakLinesAnywhereAndEndInWindowsStyle) {
  std::string text = vertex_header("ascii") + kFaceHeader + "0 0 0 1 0\n0 1 1 0\n\n0 1 0 4 0 1\n2 3";
  std::string windows;
  for (const char c : text) windows += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(read(windows).triangles, kQuad);
}

TEST_F(Ply, ReadsBothByteOrders) {
  for (const auto& [name, order] : {std::pair("binary_little_endian", std::endian::little),
                                    std::pair("binary_big_endian", std::endian::big)}) {
    const std::string body = raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, order) + raw<uint8_t>(4) +
                             raw<int32_t>({0, 1, 2, 3}, order);
    const Mesh mesh = read(vertex_header(name) + kFaceHeader + body);
    EXPECT_EQ(mesh.triangles, kQuad) << name;
    EXPECT_EQ(mesh.positions[3], (Vec3f{0, 1, 0})) << name;
  }
}

/// A file whose vertex has one attribute of each type and whose list has the given types.
template <typename Count, typename Index>
std::string typed_file(std::endian order, const std::string& names, const std::string& list_names) {
  const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
  std::string properties, name;
  for (size_t begin = 0, i = 0; begin < names.size(); ++i) {
    const size_t end = names.find(' ', begin);
    properties += "property " + names.substr(begin, end - begin) + " a" + std::to_string(i) + "\n";
    begin = end == std::string::npos ? names.size() : end + 1;
  }
  std::string body;
  const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  for (size_t v = 0; v < 4; ++v) {
    for (size_t axis = 0; axis < 3; ++axis) body += raw(positions[3 * v + axis], order);
    body += raw<int8_t>(-100) + raw<uint8_t>(200) + raw<int16_t>(-30000, order) +
            raw<uint16_t>(60000, order) + raw<int32_t>(-2000000000, order) +
            raw<uint32_t>(4000000000u, order) + raw<float>(0.5f, order) + raw<double>(0.25, order);
  }
  body += raw<Count>(4, order) + raw<Index>({0, 1, 2, 3}, order);
  return vertex_header(format, properties) + "element face 1\nproperty list " + list_names +
         " vertex_index\nend_header\n" + body;
}

TEST_F(Ply, ReadsEveryScalarTypeByBothNames) {
  const std::string old_names = "char uchar short ushort int uint float double";
  const std::string new_names = "int8 uint8 int16 uint16 int32 uint32 float32 float64";
  const std::vector<float> expected = {-100, 200, -30000, 60000, -2e9f, 4e9f, 0.5f, 0.25f};
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const std::string& names : {old_names, new_names}) {
      const Mesh mesh = read(typed_file<uint8_t, int32_t>(order, names, "uchar int"));
      ASSERT_EQ(mesh.vertex_attributes.size(), 8u);
      for (size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(mesh.vertex_attributes.at("a" + std::to_string(i)), std::vector<float>(4, expected[i]))
            << i;
      }
    }
    EXPECT_EQ(read(typed_file<uint16_t, uint16_t>(order, new_names, "ushort uint16")).triangles, kQuad);
    EXPECT_EQ(read(typed_file<int32_t, uint8_t>(order, new_names, "int uchar")).triangles, kQuad);
    EXPECT_EQ(read(typed_file<uint32_t, uint32_t>(order, new_names, "uint32 uint")).triangles, kQuad);
    EXPECT_EQ(read(typed_file<int8_t, int16_t>(order, new_names, "char short")).triangles, kQuad);
  }
}

TEST_F(Ply, KeepsPropertiesOfVerticesByName) {
  const Mesh mesh =
      read(vertex_header("ascii",
                         "property double temperature\nproperty uchar red\nproperty list uchar int ring\n") +
           kFaceHeader + "0 0 0 300.5 1 0\n1 0 0 301 2 2 7 8\n1 1 0 302 3 0\n0 1 0 303 255 1 9\n4 0 1 2 3\n");
  EXPECT_EQ(mesh.vertex_attributes.at("temperature"), (std::vector<float>{300.5f, 301, 302, 303}));
  EXPECT_EQ(mesh.vertex_attributes.at("red"), (std::vector<float>{1, 2, 3, 255}));
  EXPECT_EQ(mesh.vertex_attributes.size(), 2u);
}

TEST_F(Ply, KnowsTheNamesOfTextureCoordinates) {
  for (const auto& [u, v] : {std::pair("u", "v"), std::pair("texture_u", "texture_v"), std::pair("s", "t")}) {
    const std::string properties = std::string("property float ") + u + "\nproperty float " + v + "\n";
    const std::string text = vertex_header("ascii", properties) + kFaceHeader +
                             "0 0 0 0 0.25\n1 0 0 1 0.25\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";
    const Mesh mesh = read(text);
    ASSERT_EQ(mesh.uvs.size(), 4u) << u;
    EXPECT_EQ(mesh.uvs[1], (Vec2f{1, 0.25f})) << u;
    EXPECT_TRUE(mesh.vertex_attributes.empty()) << u;
    MeshOptions options;
    options.flip_tex_coords = true;
    EXPECT_EQ(read(text, options).uvs[1], (Vec2f{1, 0.75f})) << u;
  }
}

TEST_F(Ply, NormalsAreNormalisedOrDropped) {
  const std::string text =
      vertex_header("ascii", "property float nx\nproperty float ny\nproperty float nz\n") + kFaceHeader +
      "0 0 0 0 3 4\n1 0 0 0 3 4\n1 1 0 0 3 4\n0 1 0 0 0 0\n4 0 1 2 3\n";
  const Mesh mesh = read(text);
  EXPECT_NEAR(mesh.normals[0][1], 0.6, 1e-6);
  EXPECT_NEAR(mesh.normals[0][2], 0.8, 1e-6);
  EXPECT_EQ(mesh.normals[3], (Vec3f{0, 0, 1}));
  EXPECT_EQ(messages.texts,
            (std::vector<std::string>{
                "a.ply: warning: 1 of 4 vertex normals are missing or zero: computed from the triangles"}));
  MeshOptions options;
  options.face_normals = true;
  EXPECT_TRUE(read(text, options).normals.empty());
  EXPECT_TRUE(read(text, options).vertex_attributes.empty());
}

TEST_F(Ply, ReadsTriangleStrips) {
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  // Two strips; in the first one 1 1 turns it without a triangle.
  const Mesh mesh = read(vertex_header("ascii") + strips + square + "9 0 1 3 2 -1 1 2 2 3\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 3}, {3, 1, 2}}));
  for (const Vec3f& n : mesh.normals) EXPECT_EQ(n, (Vec3f{0, 0, 1}));
  EXPECT_TRUE(messages.texts.empty());
  const Mesh again = read(vertex_header("ascii") + strips + square + "9 -1 -1 0 1 2 -1 0 2 3\n");
  EXPECT_EQ(again.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  const std::string both = "element face 1\nproperty list uchar int vertex_indices\n" + strips;
  EXPECT_EQ(read(vertex_header("ascii") + both + square + "3 0 1 2 3 0 2 3\n").triangles,
            (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

/// Before and behind the list; a polygon's for each of its triangles; strips have none.
TEST_F(Ply, NumbersOfFaces) {
  const std::string faces =
      "element face 2\nproperty uchar red\nproperty list uchar int vertex_indices\nproperty float heat\nproperty list uchar uchar "
      "rest\n";
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const Mesh mesh = read(vertex_header("ascii") + faces + "end_header\n" + square +
                         "7 4 0 1 2 3 0.5 0\n9 3 0 1 2 1.5 1 3\n");
  EXPECT_EQ(mesh.triangles.size(), 3u);
  ASSERT_EQ(mesh.face_attributes.size(), 2u);
  EXPECT_EQ(mesh.face_attributes.at("red"), (std::vector<float>{7, 7, 9}));
  EXPECT_EQ(mesh.face_attributes.at("heat"), (std::vector<float>{0.5f, 0.5f, 1.5f}));
  EXPECT_EQ(mesh.byte_attributes, (std::set<std::string>{"face red"}));
  EXPECT_TRUE(mesh.vertex_attributes.empty());
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  EXPECT_TRUE(read(vertex_header("ascii") + faces + strips + square +
                   "7 4 0 1 2 3 0.5 0\n9 3 0 1 2 1.5 1 3\n3 0 2 3\n")
                  .face_attributes.empty());
}

/// As MeshLab has them: a vertex is split where its corners differ, and normals stay smooth across.
TEST_F(Ply, TextureCoordinatesOfCorners) {
  const std::string faces =
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property int texnumber\nend_header\n";
  const std::string bent = "0 0 0\n1 0 0\n1 1 0\n0 1 1\n";
  const Mesh mesh = read(vertex_header("ascii", "property float heat\n") + faces +
                         "0 0 0 5\n1 0 0 6\n1 1 0 7\n0 1 1 8\n"
                         "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0 0 0.5 1 0 1 0\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 4, 3}}));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2f>{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5f, 1}}));
  EXPECT_EQ(mesh.positions[4], mesh.positions[2]);
  EXPECT_EQ(mesh.normals[4], mesh.normals[2]);
  EXPECT_NE(mesh.normals[1], mesh.normals[2]);
  EXPECT_EQ(mesh.vertex_attributes.at("heat"), (std::vector<float>{5, 6, 7, 8, 7}));
  EXPECT_TRUE(messages.texts.empty());
  MeshOptions flipped;
  flipped.flip_tex_coords = true;
  EXPECT_EQ(
      read(vertex_header("ascii") + faces + bent + "3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 0 0\n", flipped).uvs,
      (std::vector<Vec2f>{{0, 1}, {1, 1}, {1, 0}, {0, 1}, {0, 1}}));
  EXPECT_EQ(messages.texts,
            (std::vector<std::string>{
                "a.ply: warning: 1 faces have no texture coordinates: (0, 0) is used",
                "a.ply: warning: 1 of 2 triangles have texture coordinates of a further picture (texnumber): "
                "read as those of one"}));
  EXPECT_EQ(
      error_of(folder,
               [&] { read(vertex_header("ascii") + faces + bent + "3 0 1 2 4 0 0 1 0 1\n3 0 2 3 0 0\n"); }),
      "a.ply:16: face 0: property 'texcoord': 4 numbers for 3 corners, must be two for each");
}

TEST_F(Ply, SkipsOtherElementsWhereverTheyStand) {
  const std::string header =
      "ply\ncomment made by hand\nformat binary_little_endian 1.0\nobj_info x\nelement camera 2\nproperty "
      "double fov\n"
      "property list ushort short marks\nelement face 1\nproperty float weight\nproperty list uchar int "
      "vertex_indices\n"
      "property list uchar uchar flags\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element empty 3\nelement tail 1\nproperty char c\nend_header\n";
  const std::string camera = raw(1.0) + raw<uint16_t>(2) + raw<int16_t>({1, 2}) + raw(2.0) + raw<uint16_t>(0);
  const std::string face =
      raw(0.5f) + raw<uint8_t>(4) + raw<int32_t>({0, 1, 2, 3}) + raw<uint8_t>(1) + raw<uint8_t>(7);
  const Mesh mesh = read(header + camera + face + raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + "c");
  EXPECT_EQ(mesh.triangles, kQuad);
  EXPECT_EQ(messages.texts,
            (std::vector<std::string>{"a.ply:5: note: element 'camera' is skipped",
                                      "a.ply:16: note: element 'empty' is skipped",
                                      "a.ply:17: note: element 'tail' is skipped",
                                      "a.ply:8: note: list 'flags' of element 'face' is skipped"}));
}

}  // namespace
}  // namespace kiloband::test
