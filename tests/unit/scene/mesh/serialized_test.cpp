// Serialized meshes that are right.
#include <gtest/gtest.h>

#include "binary.hpp"
#include "scene/mesh/mesh.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

struct Serialized : testing::Test {
  TemporaryFolder folder;
  Mesh read(const std::string& bytes, const MeshOptions& options = {}) {
    return read_serialized(folder.write("a.serialized", bytes), options);
  }
};

/// The quad with normals (0, 0, 2), texture coordinates (i, 0.25) and colours, as Real.
template <typename Real>
PlainMesh full_mesh() {
  PlainMesh mesh;
  mesh.flags = (sizeof(Real) == 8 ? 0x2000 : 0x1000) | 0x1 | 0x2 | 0x8;
  mesh.arrays = raw<Real>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
                raw<Real>({0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2}) +
                raw<Real>({0, 0.25, 1, 0.25, 2, 0.25, 3, 0.25}) + raw(std::vector<Real>(12, 0.5));
  return mesh;
}

TEST_F(Serialized, ReadsBothVersionsAndPrecisions) {
  for (const int version : {3, 4}) {
    for (const PlainMesh& plain : {full_mesh<float>(), full_mesh<double>()}) {
      const Mesh mesh = read(serialized_file(plain, version));
      EXPECT_EQ(mesh.triangles, (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
      EXPECT_EQ(mesh.positions[2], (Vec3f{1, 1, 0}));
      EXPECT_EQ(mesh.normals, (std::vector<Vec3f>(4, {0, 0, 1})));
      EXPECT_EQ(mesh.uvs[3], (Vec2f{3, 0.25f}));
    }
  }
}

TEST_F(Serialized, ComputesNormalsUnlessFaceNormals) {
  EXPECT_EQ(read(serialized_file(PlainMesh{})).normals, (std::vector<Vec3f>(4, {0, 0, 1})));
  MeshOptions options;
  options.face_normals = true;
  EXPECT_TRUE(read(serialized_file(full_mesh<float>()), options).normals.empty());
  PlainMesh flagged = full_mesh<float>();
  flagged.flags |= 0x10;
  EXPECT_TRUE(read(serialized_file(flagged)).normals.empty());
}

TEST_F(Serialized, FlipsTextureCoordinatesOnRequest) {
  MeshOptions options;
  options.flip_tex_coords = true;
  EXPECT_EQ(read(serialized_file(full_mesh<double>()), options).uvs[1], (Vec2f{1, 0.75f}));
}

TEST_F(Serialized, PicksTheMeshByIndex) {
  for (const int version : {3, 4}) {
    std::vector<std::string> streams;
    for (const float size : {1.0f, 2.0f, 3.0f}) {
      PlainMesh plain;
      plain.name = std::string(static_cast<size_t>(size) * 100, 'n');
      plain.arrays = raw<float>({0, 0, 0, size, 0, 0, size, size, 0, 0, size, 0});
      streams.push_back(deflate(plain.bytes(version)));
    }
    for (int i = 0; i < 3; ++i) {
      MeshOptions options;
      options.shape_index = i;
      EXPECT_EQ(read(serialized_file(version, streams), options).positions[1][0], static_cast<float>(i + 1));
    }
  }
}

TEST_F(Serialized, ReadsMoreThanOneChunk) {
  PlainMesh plain;
  plain.vertices = 200000;
  std::vector<float> positions;
  for (int i = 0; i < 200000; ++i)
    positions.insert(positions.end(), {static_cast<float>(i), static_cast<float>(i * 3 % 7), 0});
  plain.arrays = raw(positions);
  const Mesh mesh = read(serialized_file(plain));
  EXPECT_EQ(mesh.positions.size(), 200000u);
  EXPECT_EQ(mesh.positions[199999], (Vec3f{199999, 199999 * 3 % 7, 0}));
}

}  // namespace
}  // namespace kiloband::test
