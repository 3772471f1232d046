// The light tree: what its nodes bound, and that lights are chosen with exactly the probability that hits find.
#include "scene/compile/light/light_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "src_cpu/lanes/one_lane_glm.hpp"
#include "support.hpp"
#include "tests/support/chi_square.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/light_tree-inl.hpp"

namespace kiloband::test::light_tree_test {
namespace {

using cpu::one_lane::F;
using cpu::one_lane::M;
using cpu::one_lane::U;

std::vector<LightBounds> random_lights(std::size_t count, uint32_t seed) {
  Uniform uniform(seed);
  const auto number = [&] { return 2 * double{uniform()} - 1; };
  std::vector<LightBounds> lights(count);
  for (LightBounds& light : lights) {
    light.low = 10.0 * glm::dvec3(number(), number(), number());
    light.high = light.low + glm::dvec3(uniform(), uniform(), 0);
    light.axis = glm::normalize(glm::dvec3(number(), number(), number()) + glm::dvec3(0, 0, 1.5));
    light.cone = uniform() < 0.1f ? std::numbers::pi : 0.5 * double{uniform()};
    light.power = std::exp(4 * number());
  }
  return lights;
}

void expect_bounds(const KbLightNode& node, const LightBounds& light) {
  const glm::dvec3 centre(node.centre[0], node.centre[1], node.centre[2]);
  for (const double x : {light.low.x, light.high.x})
    for (const double y : {light.low.y, light.high.y})
      for (const double z : {light.low.z, light.high.z})
        EXPECT_LE(glm::distance(centre, glm::dvec3(x, y, z)), std::sqrt(node.radius2) * (1 + 1e-6) + 1e-5);
  if (node.cos_cone <= -1) return;
  const glm::dvec3 axis(node.axis[0], node.axis[1], node.axis[2]);
  EXPECT_LE(angle_between(axis, light.axis) + light.cone,
            std::atan2(double{node.sin_cone}, double{node.cos_cone}) + 1e-5);
}

/// Checks all nodes below one; returns its power, the lights it has and how deep they lie.
struct Below {
  double power = 0;
  std::vector<uint32_t> lights;
  int depth = 0;
};
Below check_node(const LightTree& tree, const std::vector<LightBounds>& lights, uint32_t at) {
  const KbLightNode& node = tree.nodes.at(at);
  Below below;
  if (node.right == KB_NONE) {
    below = {lights.at(node.light).power, {node.light}, 0};
    EXPECT_EQ(tree.leaves.at(node.light), at);
  } else {
    EXPECT_EQ(node.light, KB_NONE);
    const Below left = check_node(tree, lights, at + 1), right = check_node(tree, lights, node.right);
    below = {left.power + right.power, left.lights, 1 + std::max(left.depth, right.depth)};
    below.lights.insert(below.lights.end(), right.lights.begin(), right.lights.end());
  }
  for (const uint32_t light : below.lights) expect_bounds(node, lights[light]);
  EXPECT_NEAR(node.power, below.power, 1e-6 * below.power);
  return below;
}

void expect_tree(const std::vector<LightBounds>& lights, int most_deep) {
  const LightTree tree = build_light_tree(lights);
  ASSERT_EQ(tree.nodes.size(), 2 * lights.size() - 1);
  Below all = check_node(tree, lights, 0);
  std::ranges::sort(all.lights);
  for (uint32_t i = 0; i < lights.size(); ++i) EXPECT_EQ(all.lights.at(i), i);
  EXPECT_LE(all.depth, most_deep);
}

TEST(LightTree, NodesBoundTheirLights) {
  expect_tree(random_lights(1, 1), 0);
  expect_tree(random_lights(2, 2), 1);
  expect_tree(random_lights(700, 3), 40);
}

TEST(LightTree, LightsAtOnePointAreHalved) {
  std::vector<LightBounds> lights = random_lights(256, 4);
  for (LightBounds& light : lights) light.low = light.high = {1, 2, 3};
  expect_tree(lights, 8);
}

/// Each light twice as far as the one before: no cut halves their number.
TEST(LightTree, IsNotDeepForAnyArrangement) {
  std::vector<LightBounds> lights = random_lights(120, 5);
  for (std::size_t i = 0; i < lights.size(); ++i)
    lights[i].low = lights[i].high = {std::exp2(double(i) - 60), 0, 0};
  expect_tree(lights, 47);
}

/// A normal's cone and another's.
TEST(LightTree, ConesAreMerged) {
  LightBounds up, tilted;
  up.axis = {0, 0, 1}, up.cone = 0.1, tilted.axis = {std::sin(1.0), 0, std::cos(1.0)}, tilted.cone = 0.3;
  const LightBounds both = merged(up, tilted);
  EXPECT_NEAR(both.cone, 0.7, 1e-12);  // from -0.1 to 1.3
  EXPECT_NEAR(angle_between(both.axis, {std::sin(0.6), 0, std::cos(0.6)}), 0, 1e-12);
  tilted.cone = 1.2;  // holds the other
  EXPECT_EQ(merged(up, tilted).cone, 1.2);
  tilted.axis = {0, 0, -1};
  tilted.cone = 3.1;
  EXPECT_EQ(merged(up, tilted).cone, std::numbers::pi);
}

/// Lights of powers from 1 to 3000, sky and sun aside.
FlatScene lamps(const std::string& more = "") {
  std::string body = "<emitter type='constant'/>" + more;
  for (int i = 0; i < 60; ++i) {
    const std::string x = std::to_string(i % 10), y = std::to_string(i / 10);
    const std::string light = "<emitter type='area'><spectrum name='radiance' value='" +
                              std::to_string(std::exp2(i % 7 == 0 ? i / 5 : 0)) + "'/></emitter>";
    const std::string place = "<transform name='to_world'><scale value='0.1'/><rotate x='1' angle='" +
                              std::to_string(25 * i) + "'/><translate x='" + x + "' y='" + y +
                              "'/></transform>";
    const char* const types[] = {"rectangle", "sphere", "disk"};
    body += std::string("<shape type='") + types[i % 3] + "'>" + place + light + "</shape>";
  }
  const SceneDescription description = read_scene_text(scene_around(body), "scene.xml", {}, {});
  return *compile_scene(description, {parse_channels("500-510"), {}, {}});
}

constexpr double kUnits = 0x1p48;

F probability_of(const FlatScene& scene, glm::vec3 point, uint32_t light) {
  return cpu::one_lane::tree_probability(scene, cpu::to_lane(point), U(scene.tree_lights[light].leaf),
                                         M{true});
}

uint32_t chosen_at(const FlatScene& scene, glm::vec3 point, uint64_t unit, float probability) {
  const auto u = static_cast<float>(unit >> 24) * 0x1p-24f,
             v = static_cast<float>(unit & 0xffffff) * 0x1p-24f;
  const cpu::one_lane::ChosenTreeLight chosen =
      cpu::one_lane::choose_tree_light(scene, cpu::to_lane(point), u, v, M{true});
  EXPECT_EQ(chosen.probability.v, probability);
  return chosen.light.v;
}

/// In the order of the leaves every light has the random numbers of an interval whose length is its probability:
/// its first and its last number choose it. Together they are the tree's share, to the last of 48 bits.
TEST(LightTree, LightsHaveExactlyTheirProbability) {
  const FlatScene scene = lamps();
  ASSERT_TRUE(scene.features.light_tree);
  ASSERT_EQ(scene.emitter_cdf.size(), scene.emitters.size() + 2);
  ASSERT_GT(scene.emitter_cdf[1], 0.2f);
  ASSERT_LT(scene.emitter_cdf[1], 1);
  for (const glm::vec3 point : {glm::vec3(4, 3, 0.5f), glm::vec3(0, 0, 0.1f), glm::vec3(-1e3f, 1e3f, 1e3f),
                                glm::vec3(5.02f, 2.01f, 0.01f), glm::vec3(3, 3, 0)}) {
    uint64_t first = 0;
    for (const KbLightNode& node : scene.light_nodes) {
      if (node.right != KB_NONE) continue;
      const float probability = probability_of(scene, point, node.light).v;
      ASSERT_GT(probability, 0);
      const auto length = static_cast<uint64_t>(probability * kUnits);
      EXPECT_EQ(chosen_at(scene, point, first, probability), node.light);
      EXPECT_EQ(chosen_at(scene, point, first + length - 1, probability), node.light);
      first += length;
    }
    EXPECT_EQ(static_cast<double>(first), scene.emitter_cdf[1] * kUnits);
  }
}

/// Near lights that face the point are chosen more often than far ones of the same power and than their backs.
TEST(LightTree, NearAndFacingLightsCountMore) {
  const FlatScene scene = lamps();
  const auto light_of = [&](uint32_t emitter) { return scene.first_tree_light[emitter]; };
  const uint32_t near = light_of(33), far = light_of(3);  // rectangles at (3, 3) and (3, 0)
  const float angle = 25 * 33 * 3.14159265f / 180;
  const glm::vec3 normal(0, -std::sin(angle), std::cos(angle));
  const glm::vec3 front = glm::vec3(3, 3, 0) + normal, back = glm::vec3(3, 3, 0) - normal;
  EXPECT_GT(probability_of(scene, front, near).v, 5 * probability_of(scene, front, far).v);
  EXPECT_GT(probability_of(scene, front, near).v, 1000 * probability_of(scene, back, near).v);
}

TEST(LightTree, IsForManyLightsUnlessToldOtherwise) {
  const auto compiled = [](int count, LightSelection selection) {
    std::string body = "<shape type='sphere'/>";
    for (int i = 0; i < count; ++i)
      body +=
          "<emitter type='point'><point name='position' value='" + std::to_string(i) + ", 0, 0'/></emitter>";
    SceneDescription description = read_scene_text(scene_around(body), "scene.xml", {}, {});
    description.integrator.light_selection = selection;
    return compile_scene(description, {parse_channels("500-510"), {}, {}})->features.light_tree;
  };
  EXPECT_FALSE(compiled(15, LightSelection::kAutomatic));
  EXPECT_TRUE(compiled(16, LightSelection::kAutomatic));
  EXPECT_FALSE(compiled(32, LightSelection::kPower));
  EXPECT_TRUE(compiled(2, LightSelection::kTree));
  EXPECT_FALSE(compiled(1, LightSelection::kTree));
}

}  // namespace
}  // namespace kiloband::test::light_tree_test
