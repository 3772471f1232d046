// No ray leaves a closed mesh: not through edges, not through vertices, wherever the mesh lies. Without the
// growth of the boxes' far ends, or with contraction, rays leak here at some of the offsets (tried on PoCL).
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/unit/src_gpu/geometry/ray_tester.hpp"

namespace kiloband::test::watertight_test {
namespace {

constexpr std::size_t kRays = 1u << 20;
constexpr std::size_t kLaunch = 1u << 17;

const std::array<glm::vec3, 3> kOffsets = {glm::vec3(0), glm::vec3(1.5e3f),
                                           glm::vec3(148376.0f, 1234.0f, -223423.0f)};

/// Half random; a quarter from random points, a quarter from the centre, aimed at the mesh's vertices.
std::vector<KbRay> inside_rays(const Mesh& mesh, glm::vec3 centre, float reach, std::size_t count,
                               std::mt19937& random) {
  std::vector<KbRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 origin = i % 4 == 3 ? centre : centre + random_vector(random, -reach, reach);
    const glm::vec3 vertex = mesh.positions[random() % mesh.positions.size()];
    rays.push_back(make_ray(origin, i % 2 == 0 ? random_direction(random) : vertex - origin));
  }
  return rays;
}

/// The same rays, to just behind what they hit.
std::vector<KbRay> shortened(std::vector<KbRay> rays, const std::vector<KbHit>& hits) {
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i].t_max = hits[i].t * 1.0001f;
  return rays;
}

struct Leaks {
  std::size_t closest = 0, any = 0, any_near = 0;
};

Leaks count_leaks(const Mesh& mesh, glm::vec3 centre, float reach, std::size_t count) {
  FlatScene scene = empty_scene();
  add_mesh(scene, mesh);
  RayTester tester(scene);
  std::mt19937 random(7);
  Leaks leaks;
  for (std::size_t done = 0; done < count; done += kLaunch) {
    const std::vector<KbRay> rays = inside_rays(mesh, centre, reach, kLaunch, random);
    const std::vector<KbHit> hits = tester.closest(rays);
    const std::vector<uint32_t> any = tester.any(rays), any_near = tester.any(shortened(rays, hits));
    for (std::size_t i = 0; i < rays.size(); ++i) {
      leaks.closest += hits[i].primitive == KB_NONE;
      leaks.any += any[i] == 0;
      leaks.any_near += any_near[i] == 0;
    }
  }
  EXPECT_EQ(tester.faults(), 0u);
  return leaks;
}

void expect_none(const Leaks& leaks) {
  EXPECT_EQ(leaks.closest, 0u);
  EXPECT_EQ(leaks.any, 0u);
  EXPECT_EQ(leaks.any_near, 0u);
}

class Watertight : public ::testing::TestWithParam<int> {};

// 179 400 triangles. At the farthest offset coordinates are 1/64 apart:
// vertices coincide, triangles degenerate.
TEST_P(Watertight, Sphere) {
  const glm::vec3 centre = kOffsets[static_cast<std::size_t>(GetParam())];
  expect_none(count_leaks(uv_sphere(centre, 2, 300, 300), centre, 0.9f, kRays));
}

// Flat boxes, and rays in the planes of edges: origins and vertices share coordinates.
TEST_P(Watertight, Cube) {
  const glm::vec3 centre = kOffsets[static_cast<std::size_t>(GetParam())];
  expect_none(count_leaks(grid_cube(centre, 4, 64), centre, 3.5f, kRays / 4));
}

INSTANTIATE_TEST_SUITE_P(Offsets, Watertight, ::testing::Values(0, 1, 2));

// The count is not zero by construction: with one triangle missing the same rays find the hole.
TEST(Watertight, AHoleLeaks) {
  Mesh mesh = uv_sphere(glm::vec3(0), 2, 40, 40);
  mesh.indices.resize(mesh.indices.size() - 3);
  const Leaks leaks = count_leaks(mesh, glm::vec3(0), 0.9f, kLaunch);
  EXPECT_GT(leaks.closest, 0u);
  EXPECT_EQ(leaks.any, leaks.closest);
}

}  // namespace
}  // namespace kiloband::test::watertight_test
