// Damaged files: every reader returns a consistent mesh or throws InputError.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "binary.hpp"
#include "scene/mesh/mesh.hpp"
#include "support.hpp"
#include "tests/support/mutations.hpp"

namespace kiloband::test {
namespace {

void expect_consistent(const Mesh& mesh) {
  EXPECT_FALSE(mesh.triangles.empty());
  EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
  EXPECT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size());
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t index : triangle) EXPECT_LT(index, mesh.positions.size());
  }
  for (const Vec3f& p : mesh.positions)
    EXPECT_TRUE(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]));
  for (const Vec3f& n : mesh.normals) EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
  for (const auto& [name, values] : mesh.vertex_attributes)
    EXPECT_EQ(values.size(), mesh.positions.size()) << name;
}

using ReadFunction = Mesh (*)(const std::filesystem::path&, const MeshOptions&, const DiagnosticSink&);

/// At least a tenth of the mutants must be refused, or the damage is too fine.
void expect_mostly_refused(const std::string& good, const std::function<void(const std::string&)>& use) {
  const Damage damage;
  EXPECT_LT(use_mutants(good, damage, use), 0.9 * damage.times);
}

void attack(ReadFunction read, const std::string& good) {
  const TemporaryFolder folder;
  expect_mostly_refused(good, [&](const std::string& mutant) {
    expect_consistent(read(folder.write("mesh", mutant), {}, {}));
  });
}

const std::string kPlyHeader =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty "
    "float ny\n"
    "property float nz\nproperty float u\nproperty float v\nproperty uchar red\nelement face 2\n"
    "property list uchar int vertex_indices\nelement extra 1\nproperty list ushort double "
    "values\nend_header\n";

std::string binary_ply(const char* format, std::endian order) {
  std::string file = std::string("ply\nformat ") + format + " 1.0\n" + kPlyHeader;
  for (const float x : {0.0f, 1.0f}) {
    for (const float y : {0.0f, 1.0f}) file += raw<float>({x, y, 0, 0, 0, 1, x, y}, order) + raw<uint8_t>(9);
  }
  file +=
      raw<uint8_t>(4) + raw<int32_t>({0, 2, 3, 1}, order) + raw<uint8_t>(3) + raw<int32_t>({0, 1, 2}, order);
  return file + raw<uint16_t>(2, order) + raw<double>({1, 2}, order);
}

TEST(Mutations, Obj) {
  attack(
      read_obj,
      "# a quad\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 1.5 1e0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl m\n"
      "f 1/1/1 2/2/1 3/1/1 4/2/1\nf 1//1 2//1 3//1\nf 1 3 4\n");
}

TEST(Mutations, PlyText) {
  attack(read_ply, "ply\nformat ascii 1.0\n" + kPlyHeader +
                       "0 0 0 0 0 1 0 0 1\n1 0 0 0 0 1 1 0 2\n1 1 0 0 0 1 1 1 3\n0 1 0 0 0 1 0 1 255\n4 0 1 "
                       "2 3\n3 0 1 2\n2 1.5 2.5\n");
}

TEST(Mutations, PlyLittleEndian) {
  attack(read_ply, binary_ply("binary_little_endian", std::endian::little));
}
TEST(Mutations, PlyBigEndian) {
  attack(read_ply, binary_ply("binary_big_endian", std::endian::big));
}

TEST(Mutations, StlText) {
  attack(read_stl,
         "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
         "0\nendloop\nendfacet\nendsolid a\n");
}

TEST(Mutations, StlBinary) {
  attack(read_stl, std::string(80, 'h') + raw<uint32_t>(1) +
                       raw<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw<uint16_t>(0));
}

TEST(Mutations, SerializedFile) {
  attack(read_serialized, serialized_file(PlainMesh{}));
}

/// The decompressed contents are damaged, so that the zlib checksum does not stop everything.
TEST(Mutations, SerializedContents) {
  const TemporaryFolder folder;
  expect_mostly_refused(PlainMesh{}.bytes(4), [&](const std::string& mutant) {
    expect_consistent(read_serialized(folder.write("mesh", serialized_file(4, {deflate(mutant)})), {}));
  });
}

}  // namespace
}  // namespace kiloband::test
