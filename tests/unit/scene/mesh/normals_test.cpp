// Vertex normals against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/mesh/finish.hpp"

namespace kiloband::test {
namespace {

void expect_near(const Vec3f& a, const Vec3f& b, double tolerance = 1e-6) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance);
}

/// The corner of a cube at the origin: three quads, one of them split so that the corner touches two
/// triangles of 45 degrees.
Mesh cube_corner() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2},   // z = 0, two triangles at the corner
                    {3, 0, 4}, {0, 5, 4},   // x = 0
                    {0, 1, 6}, {0, 6, 5}};  // y = 0
  return mesh;
}

// Weighted by angle, each plane counts 90 degrees however it is split: the normal is the diagonal. Weights by
// area or by number of triangles would give something else once a plane has more triangles than the others.
TEST(VertexNormals, AreWeightedByAngle) {
  Mesh mesh = cube_corner();
  compute_vertex_normals(mesh);
  const float d = -1.0f / std::sqrt(3.0f);
  expect_near(mesh.normals[0], {d, d, d});
  // One plane refined: the corner's 45 degree triangle (0, 2, 1) becomes two with the same total.
  mesh.positions.push_back({1, 0.5f, 0});
  mesh.triangles[0] = {0, 7, 1};
  mesh.triangles.push_back({0, 2, 7});
  compute_vertex_normals(mesh);
  expect_near(mesh.normals[0], {d, d, d});
}

// On a sphere all normals are radial to the order of the tessellation.
TEST(VertexNormals, AreRadialOnASphere) {
  constexpr int kRings = 40, kSegments = 80;
  Mesh mesh;
  for (int i = 0; i <= kRings; ++i) {
    for (int j = 0; j < kSegments; ++j) {
      const double theta = M_PI * i / kRings, phi = 2 * M_PI * j / kSegments;
      mesh.positions.push_back({float(std::sin(theta) * std::cos(phi)),
                                float(std::sin(theta) * std::sin(phi)), float(std::cos(theta))});
    }
  }
  for (uint32_t i = 0; i < kRings; ++i) {
    for (uint32_t j = 0; j < kSegments; ++j) {
      const uint32_t a = i * kSegments + j, b = i * kSegments + (j + 1) % kSegments;
      mesh.triangles.push_back({a, a + kSegments, b + kSegments});
      mesh.triangles.push_back({a, b + kSegments, b});
    }
  }
  compute_vertex_normals(mesh);
  for (size_t i = kSegments; i < mesh.positions.size() - kSegments; ++i)
    expect_near(mesh.normals[i], mesh.positions[i], 0.01);
}

// A pyramid whose apex stands aside, as Mitsuba 3.9.1 computes its normals under four transforms: those of
// the placed triangles, whose angles are others, turned over where the transform mirrors.
TEST(VertexNormals, OfPlacedTriangles) {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0.3f, 0.1f, 1}};
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  struct Case {
    std::array<double, 3> scale;
    Vec3f first, fourth;
  };
  for (const Case& c : {Case{{1, 1, 1}, {0.8180f, -0.0219f, 0.5748f}, {-0.0404f, -0.6661f, 0.7448f}},
                        Case{{1, 1, 5}, {0.9903f, -0.0081f, 0.1388f}, {-0.0225f, -0.9761f, 0.2161f}},
                        Case{{3, 1, 0.2}, {0.0947f, -0.0015f, 0.9955f}, {-0.0177f, -0.1648f, 0.9862f}},
                        Case{{-3, 1, 0.2}, {0.0947f, 0.0015f, -0.9955f}, {-0.0177f, 0.1648f, -0.9862f}}}) {
    const LinearMap map{{{c.scale[0], 0, 0}, {0, c.scale[1], 0}, {0, 0, c.scale[2]}}};
    const std::vector<Vec3f> normals = mapped_vertex_normals(mesh, map);
    expect_near(normals[0], c.first, 6e-5);
    expect_near(normals[3], c.fourth, 6e-5);
  }
}

TEST(VertexNormals, CountTrianglesThatTheyOppose) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(count_opposed_triangles(mesh), 0u);  // no normals
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, -1}, {0, 0, -1}};
  EXPECT_EQ(count_opposed_triangles(mesh), 1u);
}

TEST(VertexNormals, SurviveExtremeScales) {
  for (const float scale : {1e-30f, 1e30f}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}};
    mesh.triangles = {{0, 1, 2}};
    compute_vertex_normals(mesh);
    for (const Vec3f& normal : mesh.normals) expect_near(normal, {0, 0, 1});
  }
}

TEST(VertexNormals, AreDefinedWhereTheSumVanishes) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};  // both sides of one triangle
  compute_vertex_normals(mesh);
  expect_near(mesh.normals[0], {0, 0, 1});
  expect_near(mesh.normals[3], {0, 0, 1});  // of no triangle
}

TEST(VertexNormals, ZeroAreaTrianglesDoNotCount) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 3}, {0, 1, 2}};
  compute_vertex_normals(mesh);
  expect_near(mesh.normals[1], {1, 0, 0});
}

TEST(VertexNormals, RepairKeepsDirectionsAndReplacesZeros) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.normals = {{3e30f, 0, 0}, {0, 1e-40f, 0}, {0, 0, 0}};
  EXPECT_EQ(repair_vertex_normals(mesh), 1u);
  expect_near(mesh.normals[0], {1, 0, 0});
  expect_near(mesh.normals[1], {0, 1, 0});
  expect_near(mesh.normals[2], {0, 0, 1});
}

}  // namespace
}  // namespace kiloband::test
