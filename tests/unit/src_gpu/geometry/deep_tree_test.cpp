// Hierarchies far deeper than log(n): the measured depth is enough, and too little of it is told.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/src_gpu/geometry/ray_tester.hpp"

namespace kiloband::test::deep_tree_test {
namespace {

/// Upright triangles at x = ratio^i with heights in proportion: each split cuts off the largest few.
FlatScene shrinking_scene(int count, double ratio) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto s = static_cast<float>(std::pow(ratio, i));
    mesh.add_triangle({s, -s, -s}, {s, s, -s}, {s, 0, s});
  }
  FlatScene scene = empty_scene();
  add_mesh(scene, mesh);
  return scene;
}

std::vector<KbRay> rays_along(int count) {
  std::mt19937 random(5);
  std::vector<KbRay> rays;
  for (int i = 0; i < count; ++i) {
    const float away = i % 2 == 0 ? -1.0f : 2.0f;
    const glm::vec3 target = random_vector(random, -1, 1) * std::exp2(-static_cast<float>(random() % 40));
    const glm::vec3 origin(away, 0, 0);
    rays.push_back(make_ray(origin, target - origin));
  }
  return rays;
}

/// The nearest upright triangle by exact means: the ray crosses the plane x = s at a known height.
float nearest(const KbRay& ray, int count, double ratio, double& margin) {
  double best = INFINITY;
  margin = INFINITY;
  for (int i = 0; i < count; ++i) {
    const double s = static_cast<float>(std::pow(ratio, i));
    const double t = (s - ray.origin[0]) / ray.direction[0];
    const double y = t * ray.direction[1] / s, z = t * ray.direction[2] / s;
    // Inside |y| <= (1 - z) / 2, z >= -1; the distance from the border decides whether float can tell.
    const double inside = std::min(z + 1, (1 - z) / 2 - std::abs(y));
    if (t <= 0) continue;
    if (t < best) margin = std::min(margin, std::abs(inside));
    if (inside >= 0 && t < best) best = t;
  }
  return static_cast<float>(best);
}

TEST(BvhDeepTree, MeasuredDepthIsEnough) {
  constexpr int kCount = 120;
  constexpr double kRatio = 0.5;
  const FlatScene scene = shrinking_scene(kCount, kRatio);
  RayTester tester(scene);
  EXPECT_GE(tester.bvh().depth, 9u);  // a balanced one of 120 primitives has 3
  const std::vector<KbRay> rays = rays_along(20000);
  const std::vector<KbHit> hits = tester.closest(rays);
  const std::vector<uint32_t> any = tester.any(rays);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    double margin = 0;
    const float t = nearest(rays[i], kCount, kRatio, margin);
    EXPECT_EQ(any[i] != 0, hits[i].primitive != KB_NONE);
    if (margin < 1e-4) continue;
    ++compared;
    EXPECT_EQ(std::isinf(t), hits[i].primitive == KB_NONE);
    if (std::isinf(t)) continue;
    EXPECT_NEAR(hits[i].t, t, 1e-5f * t);
  }
  EXPECT_GT(compared, 10000u);
  EXPECT_EQ(tester.faults(), 0u);
}

TEST(BvhDeepTree, StackOverflowIsAFault) {
  const FlatScene scene = shrinking_scene(120, 0.5);
  RayTester tester(scene, 5);
  tester.closest(rays_along(2000));
  EXPECT_EQ(tester.faults(), KB_FAULT_STACK_OVERFLOW);
  RayTester occlusion(scene, 5);
  occlusion.any(rays_along(2000));
  EXPECT_EQ(occlusion.faults(), KB_FAULT_STACK_OVERFLOW);
}

// Thousands of nested triangles around one point: Embree's own limit of depth is not met.
TEST(BvhDeepTree, NestedTriangles) {
  Mesh mesh;
  for (int i = 0; i < 4000; ++i) {
    const float s = std::pow(0.98f, static_cast<float>(i));
    mesh.add_triangle({-s, -s, -s}, {s, -s, s}, {0, s, 0});
  }
  FlatScene scene = empty_scene();
  add_mesh(scene, mesh);
  RayTester tester(scene);
  const std::vector<KbHit> hits = tester.closest(rays_along(5000));
  std::size_t found = 0;
  for (const KbHit& hit : hits) found += hit.primitive != KB_NONE;
  EXPECT_GT(found, 500u);
  EXPECT_EQ(tester.faults(), 0u);
}

}  // namespace
}  // namespace kiloband::test::deep_tree_test
