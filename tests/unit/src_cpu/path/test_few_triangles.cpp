// Scenes of few triangles: rays against the list, compared with Embree's answers, and with what closed bodies promise.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/path/path_kernels.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/zoo/scene_zoo.hpp"

namespace kiloband::test::test_few_triangles {
namespace {

using namespace cpu;

using Triangle = std::array<glm::vec3, 3>;

/// One mesh in which no triangle shares an index with another.
FlatScene scene_of(const std::vector<Triangle>& triangles) {
  FlatScene scene;
  for (const Triangle& triangle : triangles) {
    for (const glm::vec3& p : triangle) {
      scene.triangles.push_back(static_cast<uint32_t>(scene.positions.size()));
      scene.positions.push_back({p.x, p.y, p.z});
    }
  }
  scene.positions.push_back({0, 0, 0});  // behind the last one (FlatScene)
  KbShape shape{};
  shape.type = KB_SHAPE_MESH;
  shape.triangle_count = static_cast<uint32_t>(triangles.size());
  scene.shapes.push_back(shape);
  return scene;
}

/// An octahedron whose faces are cut in four twice, on a sphere: 128 triangles, the corners rounded to floats once.
std::vector<Triangle> sphere(glm::vec3 centre, float radius) {
  std::vector<Triangle> triangles;
  for (const float x : {-1.0f, 1.0f})
    for (const float y : {-1.0f, 1.0f})
      for (const float z : {-1.0f, 1.0f})
        triangles.push_back({glm::vec3{x, 0, 0}, glm::vec3{0, y, 0}, glm::vec3{0, 0, z}});
  for (int cut = 0; cut < 2; ++cut) {
    std::vector<Triangle> smaller;
    for (const auto& [a, b, c] : triangles) {
      const glm::vec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
      for (const Triangle& t : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
        smaller.push_back(t);
    }
    triangles = std::move(smaller);
  }
  for (Triangle& triangle : triangles)
    for (glm::vec3& p : triangle) p = centre + radius * p;
  return triangles;
}

std::vector<const PathKernels*> all_kernels() {
  std::vector<const PathKernels*> all{&one_lane_path_kernels()};
  for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
    if (is_available(isa)) all.push_back(&path_kernels(isa));
  return all;
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <class Queue>
void add_ray(Queue& rays, glm::vec3 origin, glm::vec3 direction, float far_end = kInfinity) {
  const uint32_t i = rays.count++;
  rays.ox[i] = origin.x, rays.oy[i] = origin.y, rays.oz[i] = origin.z;
  rays.dx[i] = direction.x, rays.dy[i] = direction.y, rays.dz[i] = direction.z;
  rays.t_max[i] = far_end;
  rays.path[i] = i;
  if constexpr (requires { rays.t_min; }) rays.t_min[i] = 0;
}

glm::vec3 random_vector(std::mt19937& random) {
  std::uniform_real_distribution<float> one(-1, 1);
  return {one(random), one(random), one(random)};
}

/// From within a sphere, not from its centre alone: towards anything, corners and points of edges.
std::unique_ptr<RayQueue> rays_within(const std::vector<Triangle>& triangles, glm::vec3 centre, float radius,
                                      std::mt19937& random) {
  auto rays = std::make_unique<RayQueue>();
  for (uint32_t i = 0; i < kWavePaths - 1; ++i) {  // no whole number of vectors
    const glm::vec3 origin = i % 8 == 7 ? centre : centre + 0.5f * radius * random_vector(random);
    const Triangle& seen = triangles[random() % triangles.size()];
    const float share = static_cast<float>(random() % 5) / 4;
    const glm::vec3 edge_point = seen[0] + share * (seen[1] - seen[0]);
    add_ray(*rays, origin, i % 4 == 0 ? random_vector(random) : edge_point - origin);
  }
  return rays;
}

uint32_t count_misses(const RayQueue& rays) {
  return static_cast<uint32_t>(std::count(rays.shape, rays.shape + rays.count, KB_NONE));
}

class ClosedBodies : public testing::TestWithParam<float> {};

/// Rays at corners and edges, from near and far: where none may leave, none does. With one triangle left out they find the hole,
/// so that the count is not zero by construction.
TEST_P(ClosedBodies, NoRayLeavesAClosedBody) {
  const glm::vec3 centre(GetParam(), 0.7f * GetParam(), -1.3f * GetParam());
  const std::vector<Triangle> closed = sphere(centre, 2);
  const auto few = find_few_triangles(scene_of(closed));
  const auto open = find_few_triangles(scene_of({closed.begin(), closed.end() - 1}));
  ASSERT_TRUE(few && open);
  EXPECT_EQ(few->corners.size(), 66u);  // V = 2 + E - F, of 128 triangles
  std::mt19937 random(5);
  const PathKernels& kernels = path_kernels(resolve_isa(Isa::kAuto));
  uint32_t leaks = 0, found = 0, passed = 0;
  for (int round = 0; round < 200; ++round) {
    const auto rays = rays_within(closed, centre, 2, random);
    const auto through = std::make_unique<RayQueue>(*rays);
    const auto shadows = std::make_unique<ShadowQueue>();
    for (uint32_t i = 0; i < rays->count; ++i)
      add_ray(*shadows, {rays->ox[i], rays->oy[i], rays->oz[i]}, {rays->dx[i], rays->dy[i], rays->dz[i]});
    kernels.closest_of_few(*few, *rays);
    kernels.occlusions_of_few(*few, *shadows);
    kernels.closest_of_few(*open, *through);
    leaks += count_misses(*rays);
    found += count_misses(*through);
    for (uint32_t i = 0; i < shadows->count; ++i) passed += shadows->t_max[i] > 0;
  }
  EXPECT_EQ(leaks, 0u);
  EXPECT_EQ(passed, 0u);
  EXPECT_GT(found, 200u);
}

TEST_P(ClosedBodies, AreMetAlikeByEveryInstructionSet) {
  const glm::vec3 centre(GetParam());
  const std::vector<Triangle> closed = sphere(centre, 2);
  const auto few = find_few_triangles(scene_of(closed));
  std::mt19937 random(6);
  const auto rays = rays_within(closed, centre, 4, random);  // some begin outside
  std::unique_ptr<RayQueue> first;
  for (const PathKernels* kernels : all_kernels()) {
    auto traced = std::make_unique<RayQueue>(*rays);
    kernels->closest_of_few(*few, *traced);
    if (!first) {
      first = std::move(traced);
      continue;
    }
    for (uint32_t i = 0; i < rays->count; ++i) {
      ASSERT_EQ(traced->shape[i], first->shape[i]);
      ASSERT_EQ(std::bit_cast<uint32_t>(traced->t_max[i]), std::bit_cast<uint32_t>(first->t_max[i]));
      if (traced->shape[i] == KB_NONE) continue;
      ASSERT_EQ(traced->primitive[i], first->primitive[i]);
      ASSERT_EQ(std::bit_cast<uint32_t>(traced->u[i]), std::bit_cast<uint32_t>(first->u[i]));
      ASSERT_EQ(std::bit_cast<uint32_t>(traced->v[i]), std::bit_cast<uint32_t>(first->v[i]));
    }
  }
  EXPECT_GT(count_misses(*first), 10u);
}

INSTANTIATE_TEST_SUITE_P(Offsets, ClosedBodies, testing::Values(0.0f, 1.5e3f, 2.0e5f));

struct Differences {
  uint32_t hits = 0, others = 0;  // others: another triangle, or none
  float distance = 0, place = 0;  // largest: relative; of barycentric coordinates
};

Differences compare(const RayQueue& traced, const std::vector<TraceRay>& expected) {
  Differences d;
  for (uint32_t i = 0; i < traced.count; ++i) {
    const TraceRay& one = expected[i];
    const bool hit = one.shape != KB_NONE;
    d.hits += hit;
    if (traced.shape[i] != one.shape || (hit && traced.primitive[i] != one.primitive)) {
      ++d.others;
    } else if (hit) {
      d.distance = std::max(d.distance, std::abs(traced.t_max[i] / one.t_max - 1));
      d.place = std::max({d.place, std::abs(traced.u[i] - one.u), std::abs(traced.v[i] - one.v)});
    }
  }
  return d;
}

/// Rays from within a room of several shapes, of all lengths, some of which end before they meet anything.
TEST(TriangleList, AreMetWhereEmbreeMeetsThem) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(zoo_scene("diffuse_room"));
  const auto few = find_few_triangles(scene);
  ASSERT_TRUE(few);
  const EmbreeScene embree(scene, Isa::kSse4, 1);
  std::mt19937 random(8);
  const auto rays = std::make_unique<RayQueue>();
  const auto shadows = std::make_unique<ShadowQueue>();
  std::vector<TraceRay> closest;
  std::vector<ShadowRay> between;
  for (uint32_t i = 0; i < kWavePaths; ++i) {
    const glm::vec3 origin = 0.5f * scene.scene_radius * random_vector(random);
    const glm::vec3 direction = std::exp2(static_cast<float>(i % 21) - 10) * random_vector(random);
    const float far_end = scene.scene_radius / glm::length(direction) * (i % 3 == 0 ? 0.3f : 4.0f);
    add_ray(*rays, origin, direction, far_end);
    add_ray(*shadows, origin, direction, far_end);
    closest.emplace_back(origin, direction, 0.0f, far_end);
    between.emplace_back(origin, direction, far_end);
  }
  embree.closest_hits(closest);
  embree.occlusions(between);
  const PathKernels& kernels = path_kernels(resolve_isa(Isa::kAuto));
  kernels.closest_of_few(*few, *rays);
  kernels.occlusions_of_few(*few, *shadows);
  const Differences d = compare(*rays, closest);
  EXPECT_GT(d.hits, kWavePaths / 2);
  EXPECT_LT(d.hits, kWavePaths * 9 / 10);
  EXPECT_LE(d.others, 1u);  // on an edge either triangle is right
  EXPECT_LT(d.distance, 2e-6f);
  EXPECT_LT(d.place, 2e-6f);
  uint32_t wrong = 0;
  for (uint32_t i = 0; i < kWavePaths; ++i) wrong += between[i].occluded() != (shadows->t_max[i] < 0);
  EXPECT_LE(wrong, 1u);
}

/// Hits lie behind t_min and before t_max, both of them excluded.
TEST(TriangleList, AreMetBetweenTheEndsOfARay) {
  const auto few = find_few_triangles(scene_of(
      {{glm::vec3{-1, -1, 3}, {3, -1, 3}, {-1, 3, 3}}, {glm::vec3{-1, -1, 5}, {3, -1, 5}, {-1, 3, 5}}}));
  for (const PathKernels* kernels : all_kernels()) {
    const auto rays = std::make_unique<RayQueue>();
    const auto shadows = std::make_unique<ShadowQueue>();
    for (const float far_end : {1.4f, 1.5f, 1.6f, kInfinity}) {
      add_ray(*rays, {0, 0, 0}, {0, 0, 2}, far_end);
      add_ray(*shadows, {0, 0, 0}, {0, 0, 2}, far_end);
    }
    for (const float near_end : {1.4f, 1.5f, 2.5f}) {
      add_ray(*rays, {0, 0, 0}, {0, 0, 2});
      rays->t_min[rays->count - 1] = near_end;
    }
    add_ray(*rays, {0, 0, 4}, {0, 0, -2});
    kernels->closest_of_few(*few, *rays);
    kernels->occlusions_of_few(*few, *shadows);
    const uint32_t hit[] = {KB_NONE, KB_NONE, 0, 0, 0, 1, KB_NONE, 0};
    const float at[] = {1.4f, 1.5f, 1.5f, 1.5f, 1.5f, 2.5f, kInfinity, 0.5f};
    for (uint32_t i = 0; i < rays->count; ++i) {
      EXPECT_EQ(rays->shape[i], hit[i] == KB_NONE ? KB_NONE : 0u) << i;
      if (hit[i] != KB_NONE) {
        EXPECT_EQ(rays->primitive[i], hit[i]) << i;
        EXPECT_EQ(rays->u[i], 0.25f) << i;
        EXPECT_EQ(rays->v[i], 0.25f) << i;
      }
      EXPECT_EQ(rays->t_max[i], at[i]) << i;
    }
    for (uint32_t i = 0; i < shadows->count; ++i) EXPECT_EQ(shadows->t_max[i] < 0, i >= 2) << i;
  }
}

/// What has no area is met by no ray, and rays that are no numbers meet nothing.
TEST(TriangleList, NothingIsMetByWhatIsNoRay) {
  const glm::vec3 a(0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(
      find_few_triangles(scene_of({{a, b, c}, {a, b, b}, {a, a, a}, {a, b, 2.0f * b}}))->triangles.size(),
      1u);
  const auto few = find_few_triangles(scene_of({{a, b, c}}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const PathKernels* kernels : all_kernels()) {
    const auto rays = std::make_unique<RayQueue>();
    const glm::vec3 origin(0.2f, 0.2f, -1);
    add_ray(*rays, origin, {0, 0, 1});
    add_ray(*rays, origin, {0, 0, 0});
    for (const float bad : {nan, kInfinity, -kInfinity}) {
      add_ray(*rays, {0.2f, bad, -1}, {0, 0, 1});
      add_ray(*rays, origin, {0, bad, 1});
    }
    add_ray(*rays, {-1, 0.2f, 0}, {1, 0, 0});  // in its plane
    kernels->closest_of_few(*few, *rays);
    EXPECT_EQ(rays->shape[0], 0u);
    for (uint32_t i = 1; i < rays->count; ++i) EXPECT_EQ(rays->shape[i], KB_NONE) << i;
  }
}

TEST(TriangleList, AreThoseOfScenesThatHaveNothingElse) {
  const ZooFolder folder;
  const FlatScene room = folder.flatten(zoo_scene("diffuse_room"));
  const std::size_t count = room.triangles.size() / 3;
  EXPECT_TRUE(find_few_triangles(room, count));
  EXPECT_FALSE(find_few_triangles(room, count - 1));
  for (const char* name : {"analytic_shapes", "instances", "gases"})
    EXPECT_FALSE(find_few_triangles(folder.flatten(zoo_scene(name)))) << name;
  const auto with = [&](const std::string& more) {
    std::string text = zoo_scene("diffuse_room").xml;
    return folder.flatten({"room", text.insert(text.rfind("</scene>"), more)});
  };
  const FlatScene filled = with(scene_text::gas("atmosphere", "0.1"));
  EXPECT_TRUE(filled.features.gas);
  EXPECT_TRUE(find_few_triangles(filled));
  EXPECT_FALSE(find_few_triangles(with(scene_text::shape("cube", scene_text::bsdf("null")))));
  EXPECT_FALSE(find_few_triangles(scene_of({})));
  std::vector<Triangle> many = sphere(glm::vec3(0), 1);
  many.push_back(many.front());
  EXPECT_EQ(many.size(), kMostFewTriangles + 1);
  EXPECT_FALSE(find_few_triangles(scene_of(many), many.size()));
}

}  // namespace
}  // namespace kiloband::test::test_few_triangles
