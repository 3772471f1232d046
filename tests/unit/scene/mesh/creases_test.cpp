// max_smooth_angle: vertices split at creases.
#include "scene/mesh/creases.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// The cube [0, 1]^3: 8 positions, 12 triangles, outwards.
Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(
        {static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1), static_cast<float>(i >> 2)});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TEST(Creases, ACubeHasSharpEdgesOrNone) {
  Mesh sharp = cube();
  split_at_creases(sharp, 89 * kDegree);
  EXPECT_EQ(sharp.positions.size(), 24u);
  compute_vertex_normals(sharp);
  for (const Vec3f& n : sharp.normals) EXPECT_NEAR(std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]), 1, 1e-6);
  Mesh smooth = cube();
  split_at_creases(smooth, 91 * kDegree);
  EXPECT_EQ(smooth.positions.size(), 8u);
  compute_vertex_normals(smooth);
  for (std::size_t i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(smooth.normals[i][axis], (2 * smooth.positions[i][axis] - 1) / std::sqrt(3.0), 1e-6);
}

TEST(Creases, AttributesOfFacesAndOfBytesStay) {
  Mesh mesh = cube();
  mesh.face_attributes["k"] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  mesh.byte_attributes.insert("vertex red");
  const Mesh before = mesh;
  split_at_creases(mesh, 89 * kDegree);
  EXPECT_EQ(mesh.face_attributes, before.face_attributes);
  EXPECT_EQ(mesh.byte_attributes, before.byte_attributes);
}

/// Triangles with vertices of their own are joined first; texture coordinates and attributes keep them apart.
TEST(Creases, EqualVerticesAreOne) {
  const Mesh joined = cube();
  Mesh apart;
  for (const auto& triangle : joined.triangles) {
    const auto first = static_cast<uint32_t>(apart.positions.size());
    for (const uint32_t vertex : triangle) apart.positions.push_back(joined.positions[vertex]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  apart.normals.assign(apart.positions.size(), {0, 0, 1});
  Mesh mesh = apart;
  split_at_creases(mesh, std::numbers::pi);
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_TRUE(mesh.normals.empty());
  mesh = apart;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.uvs.push_back({static_cast<float>(i / 3), 0});
  split_at_creases(mesh, std::numbers::pi);
  EXPECT_EQ(mesh.positions.size(), 36u);
  EXPECT_EQ(mesh.uvs.size(), 36u);
  mesh = apart;
  mesh.vertex_attributes["kelvin"].assign(mesh.positions.size(), 300);
  mesh.vertex_attributes["zero"].assign(mesh.positions.size(), 0);
  mesh.vertex_attributes["zero"][1] = -0.0f;
  split_at_creases(mesh, std::numbers::pi);
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(mesh.vertex_attributes["kelvin"].size(), 8u);
  mesh = apart;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.vertex_attributes["kelvin"].push_back(static_cast<float>(i / 3));
  split_at_creases(mesh, std::numbers::pi);
  EXPECT_EQ(mesh.positions.size(), 36u);
  EXPECT_EQ(mesh.vertex_attributes["kelvin"].size(), 36u);
}

/// A roof whose sides' normals are 40 degrees apart.
TEST(Creases, TheAngleIsThatBetweenTheNormals) {
  const auto height = static_cast<float>(std::tan(20 * kDegree));
  Mesh roof;
  roof.positions = {{-1, 0, 0}, {-1, 1, 0}, {0, 0, height}, {0, 1, height}, {1, 0, 0}, {1, 1, 0}, {9, 9, 9}};
  roof.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}, {0, 0, 2}};  // the last has no area
  for (const auto& [angle, vertices] : {std::pair{39.0, 8u}, std::pair{41.0, 6u}}) {
    Mesh mesh = roof;
    split_at_creases(mesh, angle * kDegree);
    EXPECT_EQ(mesh.triangles.size(), 5u);
    // Those of the triangle without area stand alone, which is a neighbour of nothing; what nothing uses is gone.
    EXPECT_EQ(mesh.positions.size(), vertices + 3) << angle;
  }
}

/// One crease that ends at a vertex does not split it: the way round is smooth.
TEST(Creases, ThatEndDoNotSplitTheirEnd) {
  constexpr int kAround = 12;
  Mesh fan;
  fan.positions = {{0, 0, 0}};
  for (int i = 0; i <= kAround; ++i) {  // a spiral stair: each triangle rises a little, the last falls back
    const double angle = 2 * std::numbers::pi * i / kAround;
    fan.positions.push_back(
        {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.1f * i});
  }
  for (uint32_t i = 0; i < kAround; ++i) fan.triangles.push_back({0, i + 1, i + 2});
  fan.triangles.push_back({0, kAround + 1, 1});
  split_at_creases(fan, 30 * kDegree);
  for (std::size_t i = 1; i < kAround; ++i) EXPECT_EQ(fan.triangles[i][0], fan.triangles[0][0]);
  EXPECT_NE(fan.triangles[kAround][0], fan.triangles[0][0]);
}

TEST(Creases, ReadersSplit) {
  const TemporaryFolder folder;
  folder.write("fold.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
  MeshOptions options;
  options.max_smooth_angle = 30 * kDegree;
  const Mesh mesh = read_obj(folder / "fold.obj", options);
  EXPECT_EQ(mesh.positions.size(), 6u);
  EXPECT_FALSE(mesh.front_by_normals);
  EXPECT_EQ(mesh.normals[mesh.triangles[1][0]], (Vec3f{1, 0, 0}));
  options.face_normals = true;
  EXPECT_TRUE(read_obj(folder / "fold.obj", options).normals.empty());
}

}  // namespace
}  // namespace kiloband::test
