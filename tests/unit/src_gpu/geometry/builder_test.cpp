// The hierarchy's bytes and shape: the same for any number of threads, every primitive once,
// boxes that contain.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <set>

#include "tests/unit/src_gpu/geometry/ray_tester.hpp"

namespace kiloband::test::builder_test {
namespace {

using opencl::build_bvh;
using opencl::Bvh;

Mesh triangle_soup(std::size_t count, float size, uint32_t seed) {
  std::mt19937 random(seed);
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 at = random_vector(random, -1, 1);
    const glm::vec3 a = at + random_vector(random, -size, size), b = at + random_vector(random, -size, size);
    mesh.add_triangle(a, b, at + random_vector(random, -size, size));
  }
  return mesh;
}

FlatScene scene_of(const Mesh& mesh) {
  FlatScene scene = empty_scene();
  add_mesh(scene, mesh);
  return scene;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_deterministic(const FlatScene& scene) {
  const Bvh first = build_bvh(scene, 1);
  for (const int threads : {1, 2, 4, 0, 2}) {
    const Bvh again = build_bvh(scene, threads);
    EXPECT_TRUE(same_bytes(first.nodes, again.nodes)) << threads << " threads";
    EXPECT_TRUE(same_bytes(first.primitives, again.primitives)) << threads << " threads";
    EXPECT_EQ(first.depth, again.depth);
  }
}

TEST(BvhBuilder, SameBytesForAnyThreads) {
  expect_deterministic(scene_of(uv_sphere(glm::vec3(0), 1, 200, 200)));  // many equal costs
  expect_deterministic(scene_of(triangle_soup(50000, 0.02f, 1)));
}

/// Walks the hierarchy; counts primitives, measures the depth, checks the boxes.
class Walk {
 public:
  explicit Walk(const Bvh& bvh) : bvh_(bvh) {
    const float limit = std::numeric_limits<float>::infinity();
    visit(0, glm::vec3(-limit), glm::vec3(limit), 1);
  }
  std::vector<uint32_t> leaf_primitives;
  uint32_t depth = 0;
  std::size_t nodes = 0;

 private:
  void visit(uint32_t index, glm::vec3 low, glm::vec3 high, uint32_t level) {
    ASSERT_LT(index, bvh_.nodes.size());
    ++nodes;
    depth = std::max(depth, level);
    const KbBvhNode& node = bvh_.nodes[index];
    for (int i = 0; i < KB_BVH_WIDTH; ++i) {
      if (node.child[i] == KB_BVH_NO_CHILD) continue;
      const glm::vec3 child_low(node.plane[0][i], node.plane[1][i], node.plane[2][i]);
      const glm::vec3 child_high(node.plane[3][i], node.plane[4][i], node.plane[5][i]);
      EXPECT_TRUE(glm::all(glm::greaterThanEqual(child_low, low)) &&
                  glm::all(glm::lessThanEqual(child_high, high)));
      if (node.child[i] & KB_BVH_IS_LEAF)
        visit_leaf(node.child[i], child_low, child_high);
      else
        visit(node.child[i], child_low, child_high, level + 1);
    }
  }
  /// Strictly inside: boxes are grown by one unit in the last place.
  void visit_leaf(uint32_t leaf, glm::vec3 low, glm::vec3 high) {
    for (uint32_t i = 0; i < KB_BVH_LEAF_COUNT(leaf); ++i) {
      const uint32_t id = KB_BVH_LEAF_FIRST(leaf) + i;
      leaf_primitives.push_back(id);
      ASSERT_LT(id, bvh_.primitives.size());
      for (int k = 0; k < 9; ++k) {
        EXPECT_GT(bvh_.primitives[id].corner[k], low[k % 3]);
        EXPECT_LT(bvh_.primitives[id].corner[k], high[k % 3]);
      }
    }
  }
  const Bvh& bvh_;
};

TEST(BvhBuilder, EveryPrimitiveOnceInItsBoxes) {
  const FlatScene scene = scene_of(triangle_soup(5000, 0.1f, 2));
  const Bvh bvh = build_bvh(scene);
  const Walk walk(bvh);
  EXPECT_EQ(walk.nodes, bvh.nodes.size());
  EXPECT_EQ(walk.depth, bvh.depth);
  ASSERT_EQ(walk.leaf_primitives.size(), 5000u);
  std::set<uint32_t> triangles;
  for (uint32_t i = 0; i < 5000; ++i) {
    EXPECT_EQ(walk.leaf_primitives[i], i);  // depth first: leaves stand in the order of their primitives
    triangles.insert(bvh.primitives[i].primitive);
  }
  EXPECT_EQ(triangles.size(), 5000u);
  EXPECT_EQ(bvh.stack_entries(), 3 * bvh.depth);
}

TEST(BvhBuilder, EmptyScene) {
  const FlatScene scene = empty_scene();
  const Bvh bvh = build_bvh(scene);
  EXPECT_EQ(bvh.nodes.size(), 1u);
  EXPECT_TRUE(bvh.primitives.empty());
  EXPECT_EQ(bvh.depth, 1u);
  RayTester tester(scene);
  const std::vector<KbRay> rays = {make_ray({0, 0, 0}, {0, 0, 1}), make_ray({1, 2, 3}, {-1, -2, -3}),
                                   make_ray({0, 0, 0}, {-0.0f, 1, 0})};
  for (const KbHit& hit : tester.closest(rays)) EXPECT_EQ(hit.primitive, KB_NONE);
  for (const uint32_t hit : tester.any(rays)) EXPECT_EQ(hit, 0u);
}

TEST(BvhBuilder, FewPrimitives) {
  for (uint32_t count = 1; count <= 12; ++count) {
    Mesh mesh;
    for (uint32_t i = 0; i < count; ++i) {
      const auto z = static_cast<float>(i + 1);
      mesh.add_triangle({-1, -1, z}, {1, -1, z}, {0, 1, z});
    }
    RayTester tester(scene_of(mesh));
    const std::vector<KbHit> hits =
        tester.closest({make_ray({0, 0, 0}, {0, 0, 1}), make_ray({0, 0, 99}, {0, 0, -1})});
    EXPECT_EQ(hits[0].t, 1.0f);
    EXPECT_EQ(hits[1].t, 99.0f - static_cast<float>(count));
    EXPECT_EQ(tester.any({make_ray({0, 0, 0}, {0, 0, -1})})[0], 0u);
    EXPECT_EQ(tester.faults(), 0u);
  }
}

// As on the CPU: what has no box, and what no ray can hit, stays out and harms nothing.
TEST(BvhBuilder, UnusableTrianglesStayOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  Mesh mesh;
  mesh.add_triangle({-1, -1, 5}, {1, -1, 5}, {0, 1, 5});
  mesh.add_triangle({0, 0, 1}, {0, 0, 1}, {1, 1, 1});
  mesh.add_triangle({0, 0, 1}, {1, 1, 1}, {0, 0, 1});
  mesh.add_triangle({0, 0, 1}, {0, 0, 1}, {0, 0, 1});
  mesh.add_triangle({nan, 0, 1}, {1, 1, 1}, {0, 1, 1});
  mesh.add_triangle({0, 0, 1}, {1, 1, nan}, {0, 1, 1});
  mesh.add_triangle({0, 0, 1}, {1, infinity, 1}, {0, 1, 1});
  mesh.add_triangle({0, 0, 1}, {1, 2e18f, 1}, {0, 1, 1});
  RayTester tester(scene_of(mesh));
  ASSERT_EQ(tester.bvh().primitives.size(), 1u);
  EXPECT_EQ(tester.bvh().primitives[0].primitive, 0u);
  EXPECT_EQ(tester.closest({make_ray({0, 0, 0}, {0, 0, 1})})[0].t, 5.0f);
}

}  // namespace
}  // namespace kiloband::test::builder_test
