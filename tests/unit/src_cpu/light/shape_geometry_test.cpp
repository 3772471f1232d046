// Intersections with analytic shapes against references in long double.
#include "src_cpu/geometry/shape_geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test_scene.hpp"
#include "tests/support/chi_square.hpp"

namespace kiloband::test::shape_geometry_test {

using namespace cpu;
namespace {

using Real = long double;
using Vec = glm::vec<3, Real>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Both crossings of a sphere with the line o + t d, in long double; false where the line misses.
bool sphere_roots(const KbShape& shape, Vec o, Vec d, Real& t0, Real& t1) {
  const Vec centre(shape.to_world[3], shape.to_world[7], shape.to_world[11]);
  const Vec column(shape.to_world[0], shape.to_world[4], shape.to_world[8]);
  const Real a = glm::dot(d, d), middle = glm::dot(centre - o, d) / a;
  const Vec nearest = o + middle * d - centre;
  const Real q = (glm::dot(column, column) - glm::dot(nearest, nearest)) / a;
  if (q < 0) return false;
  t0 = middle - std::sqrt(q);
  t1 = middle + std::sqrt(q);
  return true;
}

TEST(Intersection, SphereOfAllScalesAgainstLongDouble) {
  Uniform uniform(1);
  for (const double radius : {1e-6, 1.0, 1e6}) {
    for (const double far : {0.0, 1.5, 1e3, 1e6}) {  // distance of the origin, in radii
      const KbShape shape =
          make_shape(KB_SHAPE_SPHERE, placed(glm::dvec3(0.3, -0.2, 0.7) * radius, 0.3, glm::dvec3(radius)));
      const glm::dvec3 centre = sphere_geometry(shape).centre;
      for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 target = centre + random_direction(uniform) * (1.2 * radius * uniform());
        const glm::dvec3 origin = centre + random_direction(uniform) * (far * radius);
        const glm::dvec3 direction = (target - origin) * (uniform() < 0.5f ? 1.0 : 1e-3);
        if (!(glm::length(direction) > 0)) continue;
        Real t0, t1;
        const bool line_hits = sphere_roots(shape, origin, direction, t0, t1);
        const Real expected = !line_hits ? -1 : t0 > 0 ? t0 : t1;
        // Rays within 1e-9 of the tangent may go either way.
        if (line_hits && (t1 - t0) * glm::length(direction) < 1e-4 * radius) continue;
        double t = -1;
        const bool hit = intersect_analytic(shape, origin, direction, 0, kInfinity, t);
        ASSERT_EQ(hit, expected > 0);
        if (hit) {
          ASSERT_NEAR(static_cast<double>((t - expected) * glm::length(direction)) / radius, 0,
                      1e-9 * (1 + far));
        }
      }
    }
  }
}

TEST(Intersection, SphereTangents) {
  // At 1e6 radii a line that passes 1e-9 radii inside hits, 1e-9 outside misses.
  const KbShape shape = make_shape(KB_SHAPE_SPHERE, identity());
  double t = 0;
  EXPECT_TRUE(intersect_analytic(shape, {1 - 1e-9, 0, -1e6}, {0, 0, 1}, 0, kInfinity, t));
  EXPECT_NEAR(t, 1e6, 1e-4);
  EXPECT_FALSE(intersect_analytic(shape, {1 + 1e-9, 0, -1e6}, {0, 0, 1}, 0, kInfinity, t));
}

TEST(Intersection, OriginsOnTheSphere) {
  // From a point on the surface the near root is rounding error, the far one the chord 2 r cos.
  Uniform uniform(2);
  for (const double radius : {1e-6, 1.0, 1e6}) {
    const KbShape shape = make_shape(KB_SHAPE_SPHERE, placed({0, 0, 0}, 0.3, glm::dvec3(radius)));
    const double r = sphere_geometry(shape).radius;
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 n = random_direction(uniform), d = random_direction(uniform);
      const double cosine = glm::dot(n, d);
      double t = 0;
      const bool hit = intersect_analytic(shape, r * n, d, 1e-10 * r, kInfinity, t);
      if (std::fabs(cosine) < 1e-4) continue;
      ASSERT_EQ(hit, cosine < 0);
      if (hit) {
        ASSERT_NEAR(t / r, -2 * cosine, 1e-11);
      }
    }
  }
}

TEST(Intersection, IntervalIsOpen) {
  const KbShape sphere = make_shape(KB_SHAPE_SPHERE, identity());
  const KbShape disk = make_shape(KB_SHAPE_DISK, identity());
  const KbShape cylinder = make_shape(KB_SHAPE_CYLINDER, identity());
  double t = 0;
  EXPECT_TRUE(intersect_analytic(sphere, {0, 0, -3}, {0, 0, 1}, 1.5, 5, t));
  EXPECT_EQ(t, 2);
  EXPECT_TRUE(intersect_analytic(sphere, {0, 0, -3}, {0, 0, 1}, 2, 5, t));
  EXPECT_EQ(t, 4);
  t = -7;
  EXPECT_FALSE(intersect_analytic(sphere, {0, 0, -3}, {0, 0, 1}, 2, 4, t));
  EXPECT_EQ(t, -7);
  EXPECT_FALSE(intersect_analytic(disk, {0, 0, -3}, {0, 0, 1}, 3, 5, t));
  EXPECT_TRUE(intersect_analytic(disk, {0, 0, -3}, {0, 0, 1}, 2.9, 5, t));
  EXPECT_TRUE(intersect_analytic(cylinder, {-3, 0, 0.5}, {1, 0, 0}, 2, 5, t));
  EXPECT_EQ(t, 4);
  EXPECT_FALSE(intersect_analytic(cylinder, {-3, 0, 0.5}, {1, 0, 0}, 2, 4, t));
}

TEST(Intersection, HostileRaysMiss) {
  const double nan = std::nan("");
  for (const uint32_t type : {KB_SHAPE_SPHERE, KB_SHAPE_DISK, KB_SHAPE_CYLINDER}) {
    const KbShape shape = make_shape(type, identity());
    double t = 0;
    EXPECT_FALSE(intersect_analytic(shape, {nan, 0, 0}, {0, 0, 1}, 0, kInfinity, t));
    EXPECT_FALSE(intersect_analytic(shape, {0, 0, -2}, {0, nan, 1}, 0, kInfinity, t));
    EXPECT_FALSE(intersect_analytic(shape, {0.5, 0, 0.5}, {0, 0, 0}, 0, kInfinity, t));
    EXPECT_FALSE(intersect_analytic(shape, {kInfinity, 0, 0}, {0, 0, 1}, 0, kInfinity, t));
  }
  double t = 0;
  // In the disk's plane, along the cylinder's axis.
  EXPECT_FALSE(
      intersect_analytic(make_shape(KB_SHAPE_DISK, identity()), {-3, 0, 0}, {1, 0, 0}, 0, kInfinity, t));
  EXPECT_FALSE(intersect_analytic(make_shape(KB_SHAPE_CYLINDER, identity()), {0.5, 0, -3}, {0, 0, 1}, 0,
                                  kInfinity, t));
}

/// Crossings of the canonical disk and cylinder in long double,
/// with the inverse of to_world by Cramer's rule.
Real nearest_reference(const KbShape& shape, Vec origin, Vec direction) {
  const float(&m)[12] = shape.to_world;
  const Vec x(m[0], m[4], m[8]), y(m[1], m[5], m[9]), z(m[2], m[6], m[10]), c(m[3], m[7], m[11]);
  const Real det = glm::dot(x, glm::cross(y, z));
  const auto local = [&](Vec v) {
    return Vec(glm::dot(glm::cross(y, z), v), glm::dot(glm::cross(z, x), v), glm::dot(glm::cross(x, y), v)) /
           det;
  };
  const Vec o = local(origin - c), d = local(direction);
  if (shape.type == KB_SHAPE_DISK) {
    const Real t = -o.z / d.z, px = o.x + t * d.x, py = o.y + t * d.y;
    return t > 0 && px * px + py * py <= 1 ? t : -1;
  }
  const Real a = d.x * d.x + d.y * d.y, middle = -(o.x * d.x + o.y * d.y) / a;
  const Real nx = o.x + middle * d.x, ny = o.y + middle * d.y, q = (1 - nx * nx - ny * ny) / a;
  if (q < 0) return -1;
  for (const Real t : {middle - std::sqrt(q), middle + std::sqrt(q)}) {
    if (t > 0 && o.z + t * d.z >= 0 && o.z + t * d.z <= 1) return t;
  }
  return -1;
}

TEST(Intersection, DiskAndCylinderAgainstLongDouble) {
  Uniform uniform(3);
  for (const uint32_t type : {KB_SHAPE_DISK, KB_SHAPE_CYLINDER}) {
    for (const double scale : {1e-6, 1.0, 1e6}) {
      for (const double far : {0.5, 30.0, 1e6}) {
        const glm::dmat4 to_world =
            placed(glm::dvec3(1, 2, 3) * scale, 0.8, glm::dvec3(0.5, 0.7, -2) * scale);
        const KbShape shape = make_shape(type, to_world);
        int hits = 0;
        for (int i = 0; i < 3000; ++i) {
          const glm::dvec3 inside(1.2 * (2.0 * uniform() - 1), 1.2 * (2.0 * uniform() - 1),
                                  type == KB_SHAPE_DISK ? 0 : uniform());
          const glm::dvec3 target(to_world * glm::dvec4(inside, 1));
          const glm::dvec3 origin = target + random_direction(uniform) * (far * scale);
          const glm::dvec3 direction = glm::normalize(target - origin);
          const Real expected = nearest_reference(shape, origin, direction);
          double t = -1;
          const bool hit = intersect_analytic(shape, origin, direction, 0, kInfinity, t);
          hits += hit;
          // Within 1e-8 of an edge or tangent the two may differ: such rays are not among these (fixed seed).
          ASSERT_EQ(hit, expected > 0);
          if (hit) {
            ASSERT_NEAR(static_cast<double>(t - expected) / scale, 0, 1e-7 * (1 + far * 1e-3));
          }
        }
        EXPECT_GT(hits, 500);
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::shape_geometry_test
