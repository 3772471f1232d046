// Rays and triangles at the limits of their definition.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "src_cpu/geometry/ray_offset.hpp"
#include "tests/support/one_path_lights.hpp"
#include "tests/unit/src_gpu/geometry/ray_tester.hpp"

namespace kiloband::test::edge_cases_test {

using namespace cpu;
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Mesh one_triangle() {
  Mesh mesh;
  mesh.add_triangle({-1, -1, 5}, {1, -1, 5}, {0, 1, 5});
  return mesh;
}

FlatScene scene_of(const Mesh& mesh) {
  FlatScene scene = empty_scene();
  add_mesh(scene, mesh);
  return scene;
}

TEST(BvhEdgeCases, HitsLieInTheOpenInterval) {
  RayTester tester(scene_of(one_triangle()));
  const auto hit = [&](float t_min, float t_max) {
    return tester.closest({make_ray({0, 0, 0}, {0, 0, 1}, t_min, t_max)})[0].primitive != KB_NONE;
  };
  EXPECT_TRUE(hit(0, kInfinity));
  EXPECT_FALSE(hit(0, 5));
  EXPECT_TRUE(hit(0, std::nextafter(5.0f, 6.0f)));
  EXPECT_FALSE(hit(5, kInfinity));
  EXPECT_TRUE(hit(std::nextafter(5.0f, 4.0f), kInfinity));
  EXPECT_FALSE(hit(6, kInfinity));
  EXPECT_FALSE(hit(6, 4));
}

TEST(BvhEdgeCases, OcclusionReachesToTheOpenEnd) {
  RayTester tester(scene_of(one_triangle()));
  const glm::vec3 up(0, 0, 1);
  const std::vector<uint32_t> any =
      tester.any({make_ray({0, 0, 0}, up, 0, 5), make_ray({0, 0, 0}, up, 0, std::nextafter(5.0f, 6.0f)),
                  make_ray({0, 0, 5}, up), make_ray({0, 0, 5}, -up), make_ray({0, 0, 6}, up),
                  make_ray({0, 0, 0}, up, 0, -1)});
  EXPECT_EQ(any, (std::vector<uint32_t>{0, 1, 0, 0, 0, 0}));
}

// p = (1 - u - v) p0 + u p1 + v p2, whatever the length of the direction.
TEST(BvhEdgeCases, DistanceAndBarycentricCoordinates) {
  RayTester tester(scene_of(one_triangle()));
  const std::vector<KbHit> hits =
      tester.closest({make_ray({0.5f, -0.75f, 1}, {0, 0, 0.5f}), make_ray({0, 0.5f, 9}, {0, 0, -4})});
  EXPECT_FLOAT_EQ(hits[0].t, 8);
  EXPECT_NEAR(hits[0].u, 0.6875f, 1e-6f);
  EXPECT_NEAR(hits[0].v, 0.125f, 1e-6f);
  EXPECT_FLOAT_EQ(hits[1].t, 1);
  EXPECT_NEAR(hits[1].u, 0.125f, 1e-6f);
  EXPECT_NEAR(hits[1].v, 0.75f, 1e-6f);
}

TEST(BvhEdgeCases, RaysThatAreNoneMissQuickly) {
  const FlatScene scene = scene_of(uv_sphere(glm::vec3(0), 1, 300, 300));
  RayTester tester(scene);
  std::vector<KbRay> rays = {make_ray({0, 0, 0}, {0, 0, 0}), make_ray({0, 0, 0}, {-0.0f, 0, 0})};
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 origin(0.1f), direction(0.5f);
      origin[axis] = direction[axis] = bad;
      rays.push_back(make_ray(origin, glm::vec3(0.5f)));
      rays.push_back(make_ray(glm::vec3(0.1f), direction));
    }
  }
  rays.push_back(make_ray({0, 0, 0}, {0, 0, 1}, kNan, 10));
  rays.push_back(make_ray({0, 0, 0}, {0, 0, 1}, 0, kNan));
  for (const KbHit& hit : tester.closest(rays)) EXPECT_EQ(hit.primitive, KB_NONE);
  rays.erase(rays.end() - 2);  // t_min is not any_hit's
  for (const uint32_t hit : tester.any(rays)) EXPECT_EQ(hit, 0u);
  EXPECT_EQ(tester.faults(), 0u);
}

// Directions with zeros of both signs and with components that are tiny: from inside a cube every one hits a
// face at its distance, also from origins in the planes of boxes.
TEST(BvhEdgeCases, ZeroAndTinyComponents) {
  RayTester tester(scene_of(grid_cube(glm::vec3(0), 1, 8)));
  std::vector<KbRay> rays;
  for (const float small : {0.0f, -0.0f, 1e-20f, -1e-30f, 1e-37f, -1e-44f}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const float sign : {-1.0f, 1.0f}) {
        for (const float place : {0.0f, 0.25f, -0.5f, 0.1f}) {
          glm::vec3 direction(small), origin(place);
          direction[axis] = sign;
          origin[axis] = 0;
          rays.push_back(make_ray(origin, direction));
        }
      }
    }
  }
  const std::vector<KbHit> hits = tester.closest(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_NE(hits[i].primitive, KB_NONE) << i;
    EXPECT_FLOAT_EQ(hits[i].t, 1) << i;
  }
}

// A ray within a triangle's plane does not hit it; what lies behind is found.
TEST(BvhEdgeCases, RaysInThePlaneOfTriangles) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto turned = [&](float x, float y, float z) {
      const glm::vec3 v(x, y, z);
      return glm::vec3(v[(3 - axis) % 3], v[(4 - axis) % 3], v[(5 - axis) % 3]);
    };
    for (const float plane : {0.0f, 0.3f, -1000.7f}) {
      Mesh mesh;
      mesh.add_triangle(turned(1, -1, plane), turned(2, -1, plane), turned(1, 1, plane));
      mesh.add_triangle(turned(4, -1, plane - 1), turned(4, 1, plane - 1), turned(4, 0, plane + 2));
      RayTester tester(scene_of(mesh));
      const std::vector<KbHit> hits = tester.closest({make_ray(turned(0, 0, plane), turned(1, 0, 0)),
                                                      make_ray(turned(0, 0, plane), turned(2, 0.01f, -0.0f)),
                                                      make_ray(turned(0, 0, plane), turned(-1, 0, 0))});
      EXPECT_FLOAT_EQ(hits[0].t, 4);
      EXPECT_FLOAT_EQ(hits[1].t, 2);
      EXPECT_EQ(hits[2].primitive, KB_NONE);
    }
  }
}

// Slivers without area, but with three corners, are kept: harmless, whatever rounding makes of them.
TEST(BvhEdgeCases, SliversAreHarmless) {
  Mesh mesh = uv_sphere(glm::vec3(0), 1, 30, 30);
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 a = random_vector(random, -0.5f, 0.5f), step = random_vector(random, -0.1f, 0.1f);
    mesh.add_triangle(a, a + step, a + 2.0f * step);
  }
  RayTester tester(scene_of(mesh));
  std::vector<KbRay> rays;
  for (int i = 0; i < 20000; ++i)
    rays.push_back(make_ray(random_vector(random, -0.5f, 0.5f), random_direction(random)));
  for (const KbHit& hit : tester.closest(rays)) {
    ASSERT_NE(hit.primitive, KB_NONE);
    EXPECT_TRUE(hit.t > 0 && hit.t < 2.01f);
    EXPECT_TRUE(hit.u >= 0 && hit.v >= 0 && hit.u + hit.v <= 1.00001f);
  }
}

// A facet of a moulding, 1.8 m long and 2.6 mm high, 5 m from the origin. Barycentric coordinates that are
// off by rounding along its length put the hit 10^-5 m off its plane, where rays begin.
TEST(BvhEdgeCases, RaysDoNotMeetTheSliverTheyLeave) {
  const glm::vec3 a(-4.49f, 0.06866025f, -4.195f), b(-2.71f, 0.06707107f, -4.19292879f),
      c(-2.71f, 0.06866025f, -4.195f);
  Mesh mesh;
  mesh.add_triangle(a, b, c);
  RayTester tester(scene_of(mesh));
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const float offset = surface_offset(largest_of_triangle(a, b, c), normal);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(0.02f, 0.49f);
  std::vector<KbRay> rays;
  while (rays.size() < 100000) {
    const float u = uniform(random), v = uniform(random);
    const glm::vec3 direction = random_direction(random), point = (1 - u - v) * a + u * b + v * c;
    const float cosine = glm::dot(direction, normal);
    if (std::abs(cosine) < 0.05f) continue;
    rays.push_back(make_ray(offset_ray_origin(point, cosine > 0 ? normal : -normal, offset), direction));
  }
  std::size_t met = 0;
  for (const uint32_t any : tester.any(rays)) met += any;
  EXPECT_EQ(met, 0u) << "of " << rays.size();
}

using Corners = std::tuple<float, float, float, float, float, float, float, float, float>;

Corners corners_of(const KbPrimitive& p) {
  return {p.corner[0], p.corner[1], p.corner[2], p.corner[3], p.corner[4],
          p.corner[5], p.corner[6], p.corner[7], p.corner[8]};
}

// Four copies of a mesh: of primitives at equal distance the lowest index is reported.
TEST(BvhEdgeCases, LowestIndexWinsTies) {
  const Mesh mesh = uv_sphere(glm::vec3(0), 1, 40, 20);
  FlatScene scene = empty_scene();
  for (int copy = 0; copy < 4; ++copy) add_mesh(scene, mesh);
  RayTester tester(scene);
  const std::vector<KbPrimitive>& primitives = tester.bvh().primitives;
  std::map<Corners, uint32_t> lowest;
  for (uint32_t i = 0; i < primitives.size(); ++i) lowest.try_emplace(corners_of(primitives[i]), i);
  std::mt19937 random(4);
  std::vector<KbRay> rays;
  for (int i = 0; i < 20000; ++i)
    rays.push_back(make_ray(random_vector(random, -2, 2), random_direction(random)));
  std::size_t found = 0;
  for (const KbHit& hit : tester.closest(rays)) {
    if (hit.primitive == KB_NONE) continue;
    ++found;
    EXPECT_EQ(hit.primitive, lowest.at(corners_of(primitives[hit.primitive])));
  }
  EXPECT_GT(found, 2000u);
}

}  // namespace
}  // namespace kiloband::test::edge_cases_test
