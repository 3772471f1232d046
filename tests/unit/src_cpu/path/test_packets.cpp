// The rays of a wave, traced in packets, against the same rays one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "src_cpu/geometry/boundary.hpp"
#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/geometry/ray_order.hpp"
#include "src_cpu/lanes/isa.hpp"
#include "tests/support/zoo/scene_zoo.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::test::test_packets {
namespace {

using namespace cpu;

constexpr uint32_t kRays = 1003;  // no whole number of packets

glm::vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  const glm::vec3 d(normal(random), normal(random), normal(random));
  return glm::normalize(d);
}

/// Rays from points within the scene, each in its own direction.
void fill(RayQueue& rays, const FlatScene& scene, std::mt19937& random) {
  std::uniform_real_distribution<float> place(-0.5f * scene.scene_radius, 0.5f * scene.scene_radius);
  rays.count = kRays;
  for (uint32_t i = 0; i < kRays; ++i) {
    const glm::vec3 d = random_direction(random);
    rays.ox[i] = place(random), rays.oy[i] = place(random), rays.oz[i] = place(random);
    rays.dx[i] = d.x, rays.dy[i] = d.y, rays.dz[i] = d.z;
    rays.t_min[i] = 0;
    rays.t_max[i] = 4 * scene.scene_radius;
    rays.path[i] = i;
  }
}

std::vector<TraceRay> traced_one_by_one(const EmbreeScene& embree, const RayQueue& rays) {
  std::vector<TraceRay> traced;
  for (uint32_t i = 0; i < rays.count; ++i) traced.push_back(query_of(rays, i));
  embree.closest_hits(traced);
  return traced;
}

struct Differences {
  uint32_t shapes = 0, bits = 0, hits = 0;
};

Differences compare(const RayQueue& rays, const std::vector<TraceRay>& expected) {
  Differences d;
  for (uint32_t i = 0; i < kRays; ++i) {
    const TraceRay& one = expected[i];
    if (one.shape != KB_NONE) ++d.hits;
    if (rays.shape[i] != one.shape) {
      ++d.shapes;
    } else if (one.shape != KB_NONE && (rays.primitive[i] != one.primitive || rays.t_max[i] != one.t_max ||
                                        rays.u[i] != one.u || rays.v[i] != one.v)) {
      ++d.bits;
    }
  }
  return d;
}

/// Of such rays the first part; `entry` is their number. Returns the same queries.
std::vector<ShadowRay> fill_shadows(ShadowQueue& shadows, const FlatScene& scene, std::mt19937& random) {
  const auto rays = std::make_unique<RayQueue>();
  fill(*rays, scene, random);
  std::vector<ShadowRay> queries;
  shadows.count = kRays;
  for (uint32_t i = 0; i < kRays; ++i) {
    rays->t_max[i] = 0.7f * scene.scene_radius;
    const TraceRay ray = query_of(*rays, i);
    queries.emplace_back(ray.origin(), ray.direction(), ray.t_max);
    shadows.ox[i] = ray.ox, shadows.oy[i] = ray.oy, shadows.oz[i] = ray.oz;
    shadows.dx[i] = ray.dx, shadows.dy[i] = ray.dy, shadows.dz[i] = ray.dz;
    shadows.t_max[i] = ray.t_max;
    shadows.entry[i] = shadows.path[i] = i;
  }
  return queries;
}

class Packets : public testing::TestWithParam<Isa> {};

TEST_P(Packets, GiveTheAnswersOfSingleRays) {
  if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no " << to_string(GetParam());
  const ZooFolder folder;
  for (const char* name : {"diffuse_room", "analytic_shapes"}) {
    const FlatScene scene = folder.flatten(zoo_scene(name));
    const EmbreeScene embree(scene, GetParam(), 1);
    std::mt19937 random(7);
    const auto rays = std::make_unique<RayQueue>(), sorted = std::make_unique<RayQueue>();
    fill(*rays, scene, random);
    sort_rays(*rays, embree.grid(), *sorted);
    const std::vector<TraceRay> expected = traced_one_by_one(embree, *rays);
    const std::vector<TraceRay> expected_sorted = traced_one_by_one(embree, *sorted);
    embree.closest_hits(*rays, RayPackets::kIncoherent);
    embree.closest_hits(*sorted, RayPackets::kCoherent);
    const Differences incoherent = compare(*rays, expected), coherent = compare(*sorted, expected_sorted);
    EXPECT_GT(incoherent.hits, kRays / 2) << name;
    EXPECT_EQ(incoherent.shapes + incoherent.bits, 0u) << name;
    // Coherent packets may choose the other primitive of an edge that a ray meets: 71 in 3 million at most.
    EXPECT_LE(coherent.shapes + coherent.bits, 2u) << name;
  }
}

TEST_P(Packets, FindWhatIsInBetween) {
  if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no " << to_string(GetParam());
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(zoo_scene("analytic_shapes"));
  const EmbreeScene embree(scene, GetParam(), 1);
  std::mt19937 random(9);
  const auto shadows = std::make_unique<ShadowQueue>(), sorted = std::make_unique<ShadowQueue>();
  std::vector<ShadowRay> expected = fill_shadows(*shadows, scene, random);
  embree.occlusions(expected);
  sort_rays(*shadows, embree.grid(), *sorted);
  const auto count_wrong = [&](const ShadowQueue& traced) {
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < kRays; ++i)
      wrong += expected[traced.entry[i]].occluded() != (traced.t_max[i] < 0);
    return wrong;
  };
  const auto occluded = std::ranges::count_if(expected, &ShadowRay::occluded);
  EXPECT_GT(occluded, kRays / 10);
  EXPECT_LT(occluded, kRays * 9 / 10);
  embree.occlusions(*shadows, RayPackets::kIncoherent);
  EXPECT_EQ(count_wrong(*shadows), 0u);
  embree.occlusions(*sorted, RayPackets::kCoherent);
  EXPECT_LE(count_wrong(*sorted), 2u);
}

/// Balls and cubes in each other, of which every second is a null boundary; with instances: of a cube, too.
std::string bodies_and_boundaries(bool instances) {
  using namespace scene_text;
  std::mt19937 random(15);
  std::uniform_real_distribution<double> place(-3, 3), size(0.3, 0.9);
  std::string shapes =
      instances ? "<shape type='shapegroup' id='cube'>" + shape("cube", diffuse(0.5)) + "</shape>" : "";
  for (int i = 0; i < 36; ++i) {
    const double s = size(random);
    // One by one: compilers evaluate arguments in any order.
    const double x = place(random), y = place(random), z = place(random);
    const std::string where = to_world(scale(s, s, s) + translate(x, y, z));
    if (instances && i % 3 == 0)
      shapes += shape("instance", "<ref id='cube'/>" + where);
    else
      shapes += shape(i % 4 < 2 ? "sphere" : "cube", where + (i % 2 ? bsdf("null") : diffuse(0.5)));
  }
  return scene(2, perspective(lookat("0, 0, 9", "0, 0, 0"), 40, film(8)) + sky(1) + shapes);
}

/// A ray's way to t_max, closest hit by closest hit.
struct Way {
  bool hidden = false, passes = false;
};
Way way_of(const EmbreeScene& embree, const FlatScene& scene, const ShadowRay& asked) {
  Way way;
  for (float near = 0;;) {
    TraceRay ray(asked.origin(), asked.direction(), near, asked.t_max);
    embree.closest_hits({&ray, 1});
    if (ray.shape == KB_NONE) return way;
    if (!is_boundary(scene, ray.shape)) return {true, way.passes};
    way.passes = true;
    near = std::nextafter(ray.t_max, asked.t_max);
  }
}

/// What rays in a scene with null boundaries should be answered; wrong(): how many are not.
class BoundaryAnswers {
 public:
  BoundaryAnswers(const EmbreeScene& embree, const FlatScene& scene, const std::vector<ShadowRay>& queries) {
    for (const ShadowRay& query : queries) ways_.push_back(way_of(embree, scene, query));
  }
  std::ptrdiff_t hidden() const { return std::ranges::count_if(ways_, &Way::hidden); }
  std::ptrdiff_t passing() const {
    return std::ranges::count_if(ways_, [](const Way& w) { return w.passes && !w.hidden; });
  }
  uint32_t wrong(const ShadowQueue& traced) const {
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < traced.count; ++i) {
      const Way& way = ways_[traced.entry[i]];
      const bool answered_hidden = traced.t_max[i] < 0;
      wrong += answered_hidden != way.hidden || (!way.hidden && (traced.passes[i] == 1) != way.passes);
    }
    return wrong;
  }
  uint32_t wrong(const std::vector<ShadowRay>& traced) const {
    uint32_t wrong = 0;
    for (std::size_t i = 0; i < traced.size(); ++i) wrong += traced[i].occluded() != ways_[i].hidden;
    return wrong;
  }

 private:
  std::vector<Way> ways_;
};

TEST_P(Packets, NullBoundariesHideNothingAndAreNoted) {
  if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no " << to_string(GetParam());
  const ZooFolder folder;
  for (const bool instances : {false, true}) {
    SCOPED_TRACE(instances ? "instances" : "none");
    const FlatScene scene = folder.flatten({"boundaries", bodies_and_boundaries(instances)});
    ASSERT_EQ(scene.features.instances, instances);
    const EmbreeScene embree(scene, GetParam(), 1);
    std::mt19937 random(17);
    const auto shadows = std::make_unique<ShadowQueue>(), sorted = std::make_unique<ShadowQueue>();
    std::vector<ShadowRay> single = fill_shadows(*shadows, scene, random);
    sort_rays(*shadows, embree.grid(), *sorted);
    const BoundaryAnswers answers(embree, scene, single);
    EXPECT_GT(answers.hidden(), kRays / 10);
    EXPECT_GT(answers.passing(), kRays / 10);
    EXPECT_LT(answers.hidden() + answers.passing(), kRays * 9 / 10);
    std::fill_n(shadows->passes, kRays, 1);  // what queries before have left
    embree.occlusions(*shadows, RayPackets::kIncoherent);
    EXPECT_EQ(answers.wrong(*shadows), 0u);
    embree.occlusions(*sorted, RayPackets::kCoherent);
    EXPECT_LE(answers.wrong(*sorted), 2u);
    embree.occlusions(single);
    EXPECT_EQ(answers.wrong(single), 0u);
  }
}

/// 64 squares of 2 to 8 m on the ground, side by side.
std::string squares_of_all_sizes() {
  using namespace scene_text;
  std::string shapes;
  for (int i = 0; i < 64; ++i) {
    const double half = 1 + 3.0 * i / 63;
    shapes += shape("rectangle", to_world(scale(half, half, 1) + translate(10.0 * i, 0, 0)) + diffuse(0.5));
  }
  return scene(2, perspective(lookat("0, 0, 9", "0, 0, 0"), 40, film(8)) + sky(1) + shapes);
}

TEST_P(Packets, DistancesAreAsExactAsStated) {
  if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no " << to_string(GetParam());
  const ZooFolder folder;
  const FlatScene scene = folder.flatten({"squares", squares_of_all_sizes()});
  const EmbreeScene embree(scene, GetParam(), 1);
  const auto rays = std::make_unique<RayQueue>();
  std::mt19937 random(13);
  std::uniform_real_distribution<float> place(-0.9f, 0.9f);
  rays->count = kRays;
  for (uint32_t i = 0; i < kRays; ++i) {
    rays->ox[i] = 10.0f * static_cast<float>(i % 64) + place(random), rays->oy[i] = place(random);
    rays->oz[i] = 1, rays->dx[i] = rays->dy[i] = 0, rays->dz[i] = -1;
    rays->t_min[i] = 0, rays->t_max[i] = 100, rays->path[i] = i;
  }
  const std::vector<TraceRay> one_by_one = traced_one_by_one(embree, *rays);
  embree.closest_hits(*rays, RayPackets::kCoherent);
  double worst = 0;
  for (uint32_t i = 0; i < kRays; ++i) {
    ASSERT_NE(rays->shape[i], KB_NONE);
    worst = std::max({worst, std::abs(rays->t_max[i] - 1.0), std::abs(one_by_one[i].t_max - 1.0)});
  }
  RecordProperty("largest_error", std::to_string(worst / kEmbreeDistanceError));
  EXPECT_LE(worst, kEmbreeDistanceError);
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, Packets, testing::Values(Isa::kSse4, Isa::kAvx2, Isa::kAvx512),
                         [](const auto& isa) { return std::string(to_string(isa.param)); });

TEST(RayOrder, NamesEveryRayOnceOctantByOctant) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(zoo_scene("diffuse_room"));
  std::mt19937 random(11);
  const auto rays = std::make_unique<RayQueue>();
  fill(*rays, scene, random);
  rays->dx[5] = rays->oy[6] = std::numeric_limits<float>::quiet_NaN();
  const float r = scene.scene_radius;
  const RayGrid grid({-r, -r, -r}, {r, r, r});
  const auto sorted = std::make_unique<RayQueue>();
  sort_rays(*rays, grid, *sorted);
  ASSERT_EQ(sorted->count, kRays);
  std::vector<uint32_t> keys(kRays), all(kRays), paths(kRays);
  fill_ray_keys(*sorted, grid, keys.data());
  EXPECT_TRUE(std::ranges::is_sorted(keys));
  EXPECT_LT(keys.back(), 8 * kRayCells * kRayCells * kRayCells);
  for (uint32_t i = 0; i < kRays; ++i) {
    const uint32_t p = paths[i] = sorted->path[i];
    EXPECT_EQ(keys[i] / (kRayCells * kRayCells * kRayCells), (std::signbit(rays->dx[p]) ? 1u : 0u) |
                                                                 (std::signbit(rays->dy[p]) ? 2u : 0u) |
                                                                 (std::signbit(rays->dz[p]) ? 4u : 0u));
    EXPECT_EQ(std::bit_cast<uint32_t>(sorted->oy[i]), std::bit_cast<uint32_t>(rays->oy[p]));
    const bool tied = i > 0 && keys[i] == keys[i - 1];
    EXPECT_TRUE(!tied || paths[i - 1] < paths[i]);  // stable
  }
  std::iota(all.begin(), all.end(), 0u);
  std::ranges::sort(paths);
  EXPECT_EQ(paths, all);
}

TEST(RayOrder, PlacesBeyondTheBoxAreAtItsBorder) {
  const RayGrid grid({-1, 0, 5}, {1, 8, 5});  // without extent along z
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(ray_cell(-7, grid.low[0], grid.scale[0]), 0);
  EXPECT_EQ(ray_cell(0.1f, grid.low[0], grid.scale[0]), 2);
  EXPECT_EQ(ray_cell(infinity, grid.low[0], grid.scale[0]), 3);
  EXPECT_EQ(ray_cell(3.9f, grid.low[1], grid.scale[1]), 1);
  EXPECT_EQ(ray_cell(infinity, grid.low[2], grid.scale[2]), 0);
  EXPECT_EQ(ray_cell(std::numeric_limits<float>::quiet_NaN(), grid.low[0], grid.scale[0]), 0);
}

}  // namespace
}  // namespace kiloband::test::test_packets
