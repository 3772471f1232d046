// The same rays through the kernels and through Embree. Rays that graze an edge may be decided either way:
// such differences are counted, and must be rarer than 1 in 10^4.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "src_cpu/geometry/embree_scene.hpp"
#include "tests/unit/src_gpu/geometry/ray_tester.hpp"

namespace kiloband::test::agreement_test {

using namespace cpu;
namespace {

constexpr std::size_t kRays = 1u << 18;
constexpr float kNear = 0.01f;  // below, the rounding of coordinates near 1 limits both sides
constexpr float kNearInstance =
    1;  // rays are rounded once more, in the group's coordinates, by each side in its way

struct Differences {
  std::size_t hits = 0, primitive = 0, distance = 0, position = 0, occlusion = 0;
};

glm::vec3 vec3(const float* v) {
  return {v[0], v[1], v[2]};
}

/// Distance of the barycentric point from the ray's point.
float off_the_ray(const KbPrimitive& primitive, const KbHit& hit, const KbRay& ray) {
  const glm::vec3 p = (1 - hit.u - hit.v) * vec3(primitive.corner) + hit.u * vec3(primitive.corner + 3) +
                      hit.v * vec3(primitive.corner + 6);
  return glm::length(p - vec3(ray.origin) - hit.t * vec3(ray.direction));
}

Differences compare(const FlatScene& scene, const std::vector<KbRay>& rays) {
  RayTester tester(scene);
  const EmbreeScene embree(scene, Isa::kSse4, 2);
  const std::vector<KbHit> hits = tester.closest(rays);
  const std::vector<uint32_t> any = tester.any(rays);
  Differences differences;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const KbRay& r = rays[i];
    TraceRay expected(vec3(r.origin), vec3(r.direction), r.t_min, r.t_max);
    ShadowRay shadow(vec3(r.origin), vec3(r.direction), r.t_max);
    embree.closest_hits({&expected, 1});
    embree.occlusions({&shadow, 1});
    differences.occlusion += shadow.occluded() != (any[i] != 0);
    const bool hit = hits[i].primitive != KB_NONE;
    const KbPrimitive* p = hit ? &tester.bvh().primitives[hits[i].primitive] : nullptr;
    differences.hits += hit;
    if (expected.instance != KB_NONE)
      expected.shape -= expected.instance;  // primitives of groups know no more
    if (expected.shape != (p ? p->shape : KB_NONE) || (p && expected.primitive != p->primitive)) {
      ++differences.primitive;
    } else if (hit) {
      differences.distance +=
          !(std::abs(hits[i].t - expected.t_max) <=
            1e-5f * std::max(expected.t_max, expected.instance == KB_NONE ? kNear : kNearInstance));
      differences.position +=
          p->analytic == KB_SHAPE_MESH && scene.instances.empty() && !(off_the_ray(*p, hits[i], r) < 2e-5f);
    }
  }
  EXPECT_EQ(tester.faults(), 0u);
  return differences;
}

std::vector<KbRay> random_rays(uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<KbRay> rays;
  for (std::size_t i = 0; i < kRays; ++i) {
    const glm::vec3 origin = random_vector(random, -1.5f, 1.5f);
    const float length = i % 3 == 0 ? 2.5f : 1.0f;  // directions need not be unit vectors
    rays.push_back(make_ray(origin, length * random_direction(random), 0, i % 2 == 0 ? INFINITY : 0.5f));
  }
  return rays;
}

void add_soup(FlatScene& scene, std::size_t count, float size, std::mt19937& random) {
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 at = random_vector(random, -1, 1);
    const glm::vec3 a = at + random_vector(random, -size, size), b = at + random_vector(random, -size, size);
    mesh.add_triangle(a, b, at + random_vector(random, -size, size));
  }
  add_mesh(scene, mesh);
}

/// most_distances: of instances that rays graze, where both sides round in their ways
void expect_agreement(const Differences& d, std::size_t most_distances = 0) {
  EXPECT_GT(d.hits, kRays / 8);
  EXPECT_LT(d.primitive, kRays / 10000);
  EXPECT_LT(d.occlusion, kRays / 10000);
  EXPECT_LE(d.distance, most_distances);
  EXPECT_EQ(d.position, 0u);
}

TEST(BvhAgreement, TriangleSoup) {
  std::mt19937 random(11);
  FlatScene scene = empty_scene();
  add_soup(scene, 20000, 0.05f, random);
  expect_agreement(compare(scene, random_rays(12)));
}

TEST(BvhAgreement, ClosedMesh) {
  FlatScene scene = empty_scene();
  add_mesh(scene, uv_sphere(glm::vec3(0.1f), 1, 100, 100));
  add_mesh(scene, grid_cube(glm::vec3(0.4f), 0.5f, 20));
  expect_agreement(compare(scene, random_rays(13)));
}

/// Turned, mirrored and flattened instances of a body of two meshes, among a soup.
TEST(BvhAgreement, Instances) {
  std::mt19937 random(16);
  FlatScene scene = empty_scene();
  add_mesh(scene, uv_sphere(glm::vec3(0.1f), 0.3f, 40, 40));
  add_mesh(scene, grid_cube(glm::vec3(-0.2f), 0.2f, 5));
  std::vector<glm::dmat4> places;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 axis(random_direction(random)), at(random_vector(random, -1, 1)),
        size(random_vector(random, 0.2f, 0.9f));
    const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1), at), 0.1 * i, axis);
    places.push_back(glm::scale(turned, i % 3 == 0   ? glm::dvec3(-size.x, size.y, size.z)
                                        : i % 3 == 1 ? glm::dvec3(size.x, 0.3 * size.y, size.z)
                                                     : size));
  }
  make_group(scene, places);
  add_soup(scene, 500, 0.05f, random);
  expect_agreement(compare(scene, random_rays(17)), kRays / 50000);
}

/// Three axes of different lengths, not orthogonal for disks and cylinders; spheres need a similarity.
glm::mat3 random_axes(std::mt19937& random, uint32_t type) {
  const glm::vec3 x = random_direction(random), y = glm::normalize(glm::cross(x, random_direction(random)));
  const glm::mat3 rotation(x, y, glm::cross(x, y));
  const glm::vec3 scale = random_vector(random, 0.05f, 0.2f);
  if (type == KB_SHAPE_SPHERE) return rotation * scale.x;
  return glm::mat3(scale.x * rotation[0], scale.y * (rotation[1] + 0.2f * rotation[0]),
                   scale.z * rotation[2]);
}

TEST(BvhAgreement, AnalyticShapesAmongTriangles) {
  std::mt19937 random(14);
  FlatScene scene = empty_scene();
  for (int i = 0; i < 200; ++i) {
    for (const uint32_t type : {KB_SHAPE_SPHERE, KB_SHAPE_DISK, KB_SHAPE_CYLINDER})
      add_analytic(scene, type, random_axes(random, type), random_vector(random, -1, 1));
  }
  add_soup(scene, 500, 0.05f, random);
  expect_agreement(compare(scene, random_rays(15)));
}

}  // namespace
}  // namespace kiloband::test::agreement_test
