// Primitives against closed forms of their volume: an inscribed mesh is smaller by a factor
// that its divisions tell.
#include "scenes/generator/primitives.hpp"

#include <gtest/gtest.h>

#include "scenes/generator/implicit.hpp"
#include "tests/unit/scenes/mesh_checks.hpp"

namespace kiloband::test {
namespace {

using namespace generator;

/// Area of a regular polygon of n corners over that of its circle.
double polygon_share(int n) {
  return n / (2 * kPi) * sine(2 * kPi / n);
}

void expect_sound(const Mesh& mesh, double volume, double tolerance) {
  const Mesh rounded = in_single_precision(mesh);
  EXPECT_EQ(fault_of(rounded), "");
  EXPECT_TRUE(is_manifold(rounded));
  EXPECT_EQ(share_of_turned_normals(rounded), 0);
  EXPECT_NEAR(signed_volume6(rounded) / 6, volume, tolerance * volume);
}

TEST(Primitives, BoxWithRoundEdges) {
  const double x = 1.2, y = 0.5, z = 0.8, r = 0.05, a = x - 2 * r, b = y - 2 * r, c = z - 2 * r;
  // Steiner's formula: inner box, its faces moved out by r, its edges as quarter cylinders,
  // its corners as a ball.
  const double volume =
      a * b * c + 2 * r * (a * b + b * c + c * a) + kPi * r * r * (a + b + c) + 4 * kPi / 3 * r * r * r;
  expect_sound(rounded_box({x, y, z}, r, 16), volume, 1e-4);
  expect_sound(rounded_box({x, y, z}, r, 1), volume, 1e-2);
}

TEST(Primitives, BallCylinderTube) {
  expect_sound(ball({0.3, -0.2, 0.1}, 0.4, 64), 4 * kPi / 3 * 0.064, 2e-3);
  expect_sound(lathe({{0, 0}, {0.2, 0}, {0.2, 0.7}, {0, 0.7}}, 48), kPi * 0.04 * 0.7 * polygon_share(48),
               1e-6);
  expect_sound(tube(
                   {{0, 0, 0}, {0, 0, 0.5}, {0, 0, 2}}, [](double) { return 0.1; }, 24),
               kPi * 0.01 * 2 * polygon_share(24), 1e-6);
}

/// A torus has the volume of its section times the way of the section's centre (Pappus).
TEST(Primitives, RingIsClosed) {
  expect_sound(lathe({{0.5, 0}, {0.6, 0}, {0.6, 0.1}, {0.5, 0.1}}, 90, true),
               0.01 * 2 * kPi * 0.55 * polygon_share(90), 1e-6);
}

TEST(Primitives, MirroringKeepsTheOutside) {
  const Mesh mesh = transformed(rounded_box({1, 1, 1}, 0.1, 3), translate({3, 1, 2}) * scale({-2, 1, 0.5}));
  expect_sound(mesh, (0.512 + 6 * 0.064 + 3 * 0.8 * kPi * 0.01 + 4 * kPi / 3 * 0.001), 1e-2);
}

TEST(Primitives, CreasesSplitNormals) {
  const Mesh cylinder = lathe({{0, 0}, {0.2, 0}, {0.2, 0.7}, {0, 0.7}}, 32);
  for (const auto& t : cylinder.triangles) {
    for (const uint32_t v : t) {
      const Vec3 p = cylinder.positions[v], n = cylinder.normals[v];
      const bool up_or_down = std::fabs(std::fabs(n.y) - 1) < 1e-12;
      const bool radial = std::fabs(n.y) < 1e-12 && std::fabs(dot(n, normalize({p.x, 0, p.z})) - 1) < 1e-3;
      EXPECT_TRUE(up_or_down || radial);
    }
  }
}

TEST(Primitives, PictureIsUprightForItsViewer) {
  const Mesh mesh = picture({-1, 1, 0}, {2, 0, 0}, {0, -2, 0});
  EXPECT_EQ(mesh.normals[0], (Vec3{0, 0, 1}));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_EQ(mesh.uvs[i].x, (mesh.positions[i].x + 1) / 2);
    EXPECT_EQ(mesh.uvs[i].y, (1 - mesh.positions[i].y) / 2);
  }
}

/// Marching tetrahedra put vertices on the ball (but for those kept away from lattice points
/// by 6 % of an edge).
TEST(Implicit, BallAndItsNormals) {
  const double step = 0.05;
  const Mesh mesh = surface_of([](Vec3 p) { return sphere_distance(p, {}, 0.5); },
                               {{-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}}, step);
  expect_sound(mesh, kPi / 6, 5e-3);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(length(mesh.positions[i]), 0.5, 0.06 * step * 1.7321);
    EXPECT_NEAR(dot(mesh.normals[i], normalize(mesh.positions[i])), 1, 1e-6);
  }
}

/// Two balls that touch the lattice in hard ways, and a tunnel through a body:
/// closed whatever the field does.
TEST(Implicit, StaysManifold) {
  const auto bodies = [](Vec3 p) {
    const double two =
        blend(sphere_distance(p, {-0.25, 0, 0}, 0.3), sphere_distance(p, {0.25, 0, 0}, 0.25), 0.05);
    return blend_difference(two, capsule_distance(p, {0, 0, -1}, {0, 0, 1}, 0.1, 0.15), 0.02);
  };
  const Mesh mesh = surface_of(bodies, {{-0.7, -0.5, -0.5}, {0.7, 0.5, 0.5}}, 0.0625);
  EXPECT_EQ(fault_of(in_single_precision(mesh)), "");
  EXPECT_TRUE(is_manifold(in_single_precision(mesh)));
}

}  // namespace
}  // namespace kiloband::test
