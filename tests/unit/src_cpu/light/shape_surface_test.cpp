// Attributes, areas and area sampling of analytic shapes, and the offset of ray origins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"
#include "test_scene.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::shape_surface_test {

using namespace cpu;
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Surface, AttributesFollowTheParameterisation) {
  // At u, v of each shape: position from the formulas of the conventions,
  // normal and tangent by finite differences.
  const glm::dmat4 to_world = placed({1, 2, 3}, 0.8, {2, 2, 2});
  const auto canonical = [](uint32_t type, double u, double v) -> glm::dvec3 {
    const double two_pi = 6.283185307179586;
    if (type == KB_SHAPE_SPHERE) {
      const double theta = v * two_pi / 2;
      return {std::sin(theta) * std::cos(two_pi * u), std::sin(theta) * std::sin(two_pi * u),
              std::cos(theta)};
    }
    if (type == KB_SHAPE_DISK) return {u * std::cos(two_pi * v), u * std::sin(two_pi * v), 0};
    return {std::cos(two_pi * u), std::sin(two_pi * u), v};
  };
  Uniform uniform(4);
  for (const uint32_t type : {KB_SHAPE_SPHERE, KB_SHAPE_DISK, KB_SHAPE_CYLINDER}) {
    for (const uint32_t flags : {0u, KB_SHAPE_FLIP_NORMALS}) {
      const KbShape shape = make_shape(type, to_world, flags);
      for (int i = 0; i < 200; ++i) {
        const double u = 0.01 + 0.98 * uniform(), v = 0.01 + 0.98 * uniform(), h = 1e-5;
        const auto world = [&](double a, double b) {
          return glm::dvec3(to_world * glm::dvec4(canonical(type, a, b), 1));
        };
        const glm::dvec3 p = world(u, v);
        glm::dvec3 outward = glm::normalize(
            type == KB_SHAPE_DISK
                ? glm::dvec3(to_world[2])
                : glm::dmat3(to_world) * (canonical(type, u, v) * glm::dvec3(1, 1, type == KB_SHAPE_SPHERE)));
        if (flags) outward = -outward;
        // The hit was rounded along the ray: off the surface by 1e-6.
        const SurfacePoint point = analytic_surface(shape, p + 1e-6 * outward);
        ASSERT_LT(glm::length(glm::dvec3(point.position) - p), 1e-6);
        ASSERT_LT(glm::length(glm::dvec3(point.normal) - outward), 1e-6);
        const glm::dvec3 tangent = glm::normalize(world(u + h, v) - world(u - h, v));
        ASSERT_LT(glm::length(glm::dvec3(point.tangent) - tangent), 1e-5);
        ASSERT_NEAR(point.uv.x, u, 1e-5);
        ASSERT_NEAR(point.uv.y, v, 1e-5);
      }
    }
  }
}

TEST(Surface, ReflectionsKeepNormalsOutward) {
  const glm::dmat4 mirrored = placed({0, 0, 0}, 0.8, {-1, 1, 1});
  const KbShape sphere = make_shape(KB_SHAPE_SPHERE, mirrored);
  const glm::vec3 p = sample_analytic_area(sphere, {0.2f, 0.3f}).position;
  EXPECT_GT(glm::dot(analytic_surface(sphere, p).normal, p), 0.99f);
  EXPECT_GT(glm::dot(sample_analytic_area(sphere, {0.2f, 0.3f}).normal, p), 0.99f);
  // A disk's normal is the image of its +Z side.
  const KbShape disk = make_shape(KB_SHAPE_DISK, mirrored);
  const glm::vec3 z(mirrored[2]);
  EXPECT_GT(glm::dot(analytic_surface(disk, {0, 0, 0}).normal, z), 0.99f);
  EXPECT_GT(glm::dot(sample_analytic_area(disk, {0.2f, 0.3f}).normal, z), 0.99f);
}

TEST(Surface, DegeneratePointsHaveAFrame) {
  for (const uint32_t type : {KB_SHAPE_SPHERE, KB_SHAPE_DISK, KB_SHAPE_CYLINDER}) {
    const KbShape shape = make_shape(type, identity());
    for (const glm::dvec3 p : {glm::dvec3(0, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
      const SurfacePoint point = analytic_surface(shape, p);
      EXPECT_NEAR(glm::length(point.normal), 1, 1e-6);
      EXPECT_NEAR(glm::length(point.tangent), 1, 1e-6);
      EXPECT_NEAR(glm::dot(point.normal, point.tangent), 0, 1e-6);
    }
  }
}

/// 100 000 area samples on 16 x 16 bins of equal area in uv, which the conventions give: error rate 1e-5, an
/// RMS deviation of 3.6 % is found with probability 0.95.
TEST(AreaSampling, UniformOnEveryShape) {
  for (const uint32_t type : {KB_SHAPE_SPHERE, KB_SHAPE_DISK, KB_SHAPE_CYLINDER}) {
    const KbShape shape =
        make_shape(type, placed({1, 2, 3}, 0.8, {0.5, 0.5, type == KB_SHAPE_CYLINDER ? 3 : 0.5}));
    Uniform uniform(5);
    SquareCounts counts(16);
    for (int i = 0; i < 100000; ++i) {
      const AreaPoint point = sample_analytic_area(shape, uniform.pair());
      const SurfacePoint surface = analytic_surface(shape, glm::dvec3(point.position));
      EXPECT_LT(glm::length(surface.position - point.position), 2e-6f);
      EXPECT_LT(glm::length(surface.normal - point.normal), 3e-6f);
      double a = surface.uv.x, b = surface.uv.y;
      if (type == KB_SHAPE_SPHERE) b = (1 - std::cos(3.14159265358979 * b)) / 2;
      if (type == KB_SHAPE_DISK) a = a * a;
      counts.add(a, b);
    }
    EXPECT_GT(counts.p_value(), kTestLevel) << "shape type " << type;
  }
}

TEST(Area, ClosedForms) {
  const double pi = 3.14159265358979;
  EXPECT_NEAR(analytic_area(KB_SHAPE_SPHERE, placed({1, 2, 3}, 1, {2, 2, 2})), 16 * pi, 1e-5);
  EXPECT_NEAR(analytic_area(KB_SHAPE_DISK, placed({1, 2, 3}, 1, {2, 3, 1})), 6 * pi, 1e-5);
  EXPECT_NEAR(analytic_area(KB_SHAPE_CYLINDER, placed({1, 2, 3}, 1, {2, 2, 5})), 20 * pi, 1e-5);
}

TEST(RayOffset, FollowsTheCornersAndNotThePoint) {
  // Level: 2^-19 of the height, and 2^-22 of the width for tests that mix the axes.
  EXPECT_EQ(surface_offset({8, 8, 2}, {0, 0, 1}), 2 * 0x1p-19f + 8 * 0x1p-22f);
  EXPECT_EQ(surface_offset({8, 8, 0}, {0, 0, -1}), 8 * 0x1p-22f);
  const glm::vec3 largest = largest_of_triangle({1e-6f, 0, -2e-6f}, {0, -3e-6f, 0}, {0, 0, 1e-6f});
  EXPECT_EQ(largest, glm::vec3(1e-6f, 3e-6f, 2e-6f));
  EXPECT_LT(surface_offset(largest, {0.6f, 0.8f, 0}),
            1e-11f);  // a triangle of micrometres: far below its size
  EXPECT_EQ(offset_ray_origin({1, 2, 3}, {0, 0, 1}, 0.5f), glm::vec3(1, 2, 3.5f));
  EXPECT_EQ(target_offset(0.25f, {-1, 4, 2}), 0.25f + 4 * 0x1p-20f);
  const KbShape ball = make_shape(KB_SHAPE_SPHERE, placed({-5, 1, 2}, 0, {2, 2, 2}));
  EXPECT_EQ(largest_coordinates(ball), glm::vec3(7, 3, 4));
}

/// Points next to an edge are kept eight offsets inside, others stay where they are;
/// slivers keep a point too.
TEST(RayOffset, KeepsPointsOffTheEdges) {
  const glm::vec3 corners[3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  const glm::vec3 normal(0, 0, 4);
  constexpr float kOffset = 1e-4f;
  const auto moved = [&](float x, float y) {
    return off_the_edges({x, y, 0}, {1 - (x + y) / 2, x / 2, y / 2}, corners, normal, kOffset);
  };
  EXPECT_EQ(moved(0.5f, 1), glm::vec3(0.5f, 1, 0));
  EXPECT_EQ(moved(0.001f, 0.7f), glm::vec3(0.001f, 0.7f, 0));
  for (const glm::vec2 at : {glm::vec2(0, 0.5f), {0.5f, 0}, {0.5f, 1.5f}, {-1e-7f, 0}, {2, 0}, {0, 2}}) {
    const glm::vec3 inside = moved(at.x, at.y);
    EXPECT_LT(glm::length(glm::vec2(inside) - at), 30 * kOffset);
    EXPECT_GT(inside.x, 7.9f * kOffset);
    EXPECT_GT(inside.y, 7.9f * kOffset);
    EXPECT_GT((2 - inside.x - inside.y) / std::sqrt(2.0f), 7.9f * kOffset);
  }
  const glm::vec3 sliver[3] = {{0, 0, 0}, {2, 0, 0}, {1, 1e-4f, 0}};
  const glm::vec3 kept = off_the_edges({1, 0, 0}, {0.5f, 0.5f, 0}, sliver, {0, 0, 2e-4f}, kOffset);
  EXPECT_NEAR(kept.y, 1e-4f / 8, 1e-9f);
  EXPECT_NEAR(kept.x, 1, 1e-6f);
}

TEST(RayOffset, KeepsPointsOffTheRims) {
  constexpr float kOffset = 1e-4f;
  const KbShape disk = make_shape(KB_SHAPE_DISK, placed({0, 0, 0}, 0, {2, 2, 1}));
  EXPECT_EQ(off_the_rim(disk, {1, 0, 0}, {0.5f, 0}, kOffset), glm::vec3(1, 0, 0));
  EXPECT_NEAR(off_the_rim(disk, {2, 0, 0}, {1, 0}, kOffset).x, 2 - 8 * kOffset, 1e-6);
  const KbShape tube = make_shape(KB_SHAPE_CYLINDER, placed({0, 0, 0}, 0, {1, 1, 4}));
  EXPECT_EQ(off_the_rim(tube, {1, 0, 2}, {0, 0.5f}, kOffset), glm::vec3(1, 0, 2));
  EXPECT_NEAR(off_the_rim(tube, {1, 0, 4}, {0, 1}, kOffset).z, 4 - 8 * kOffset, 1e-6);
  EXPECT_NEAR(off_the_rim(tube, {1, 0, 0}, {0, 0}, kOffset).z, 8 * kOffset, 1e-6);
}

TEST(RayOffset, NoSelfIntersectionOnSpheres) {
  // From the offset point outwards no ray finds the sphere again.
  Uniform uniform(7);
  for (const double radius : {0.1, 1.0, 1e4}) {
    const KbShape shape = make_shape(KB_SHAPE_SPHERE, placed({0.2, 3, -1}, 0.3, glm::dvec3(radius)));
    for (int i = 0; i < 5000; ++i) {
      const SurfacePoint point =
          analytic_surface(shape, sphere_geometry(shape).centre + radius * random_direction(uniform));
      glm::dvec3 d = random_direction(uniform);
      if (glm::dot(d, glm::dvec3(point.normal)) < 0) d = -d;
      double t = 0;
      const float offset = surface_offset(largest_coordinates(shape), point.normal);
      const glm::dvec3 origin(offset_ray_origin(point.position, point.normal, offset));
      ASSERT_FALSE(intersect_analytic(shape, origin, d, 0, kInfinity, t)) << radius;
    }
  }
}

}  // namespace
}  // namespace kiloband::test::shape_surface_test
