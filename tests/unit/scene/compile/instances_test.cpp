// Instances: meshes are stored once, records say where they stand.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::instances_test {
namespace {

FlatScene compiled(const std::string& shapes, const DiagnosticSink& sink = {}) {
  const std::string scene = "<scene version='3.0.0'>" + shapes +
                            "<emitter type='constant'/><sensor type='perspective'><transform name='to_world'>"
                            "<translate z='5'/></transform></sensor></scene>";
  const ChannelList channels = parse_channels("500-510");
  return *compile_scene(read_scene_text(scene, "scene.xml", "."), {channels, channels, sink});
}
std::string placed(const std::string& steps) {
  return "<transform name='to_world'>" + steps + "</transform>";
}
std::string instance(const std::string& steps, const std::string& group = "g") {
  return "<shape type='instance'><ref id='" + group + "'/>" + placed(steps) + "</shape>";
}
const std::string kGroup = "<shape type='shapegroup' id='g'><shape type='cube'>" +
                           placed("<translate x='1000'/>") + "</shape><shape type='rectangle' id='r'>" +
                           placed("<translate x='1002'/>") + "</shape></shape>";

/// A vertex in the coordinates of the scene file.
glm::dvec3 vertex(const FlatScene& scene, const KbShape& shape, uint32_t corner) {
  const KbFloat3& p = scene.positions[scene.triangles[3 * std::size_t{shape.first_triangle} + corner]];
  glm::dvec3 world;
  for (int row = 0; row < 3; ++row) {
    const float* m = &shape.to_world[4 * row];
    world[row] = double{m[0]} * double{p.x} + double{m[1]} * double{p.y} + double{m[2]} * double{p.z} +
                 double{m[3]} + scene.origin[static_cast<std::size_t>(row)];
  }
  return world;
}

TEST(Instances, ShareVertices) {
  const FlatScene one = compiled(kGroup + instance("")),
                  three = compiled(kGroup + instance("") + instance("<scale x='-1'/>") +
                                   instance("<rotate z='1' angle='90'/><translate z='7'/>"));
  EXPECT_EQ(three.positions.size(), one.positions.size());
  EXPECT_EQ(three.triangles.size(), one.triangles.size());
  ASSERT_EQ(three.groups.size(), 1u);
  EXPECT_EQ(three.groups[0].shape_count, 2u);
  ASSERT_EQ(three.instances.size(), 3u);
  ASSERT_EQ(three.shapes.size(), 6u);
  for (uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(three.instances[i].first_shape, 2 * i);
    for (uint32_t member = 0; member < 2; ++member) {
      const KbShape& shape = three.shapes[2 * i + member];
      EXPECT_EQ(shape.first_triangle, three.shapes[member].first_triangle);
      EXPECT_TRUE(shape.flags & KB_SHAPE_INSTANCED);
      EXPECT_EQ((shape.flags & KB_SHAPE_MIRRORED) != 0, i == 1);
    }
  }
  EXPECT_TRUE(three.features.instances);
  EXPECT_EQ(three.shape_names[1], "r");
}

// Where the group was modelled does not matter: its coordinates are about its middle.
TEST(Instances, StandWhereTheyBelong) {
  const FlatScene scene =
      compiled(kGroup + instance("<rotate z='1' angle='90'/><scale value='0.5'/><translate z='7'/>"));
  const FlatScene plain = compiled("<shape type='cube'>" + placed("<translate x='1000'/>") + "</shape>");
  for (const KbFloat3& p : scene.positions) EXPECT_LT(std::abs(p.x), 3);
  for (uint32_t corner = 0; corner < 36; ++corner) {
    const KbFloat3& p = plain.positions[plain.triangles[corner]];
    const glm::dvec3 own =
        glm::dvec3(p.x, p.y, p.z) + glm::dvec3(plain.origin[0] - 1000, plain.origin[1], plain.origin[2]);
    const glm::dvec3 expected(-0.5 * own.y, 0.5 * (own.x + 1000), 0.5 * own.z + 7);
    EXPECT_LT(glm::length(vertex(scene, scene.shapes[0], corner) - expected), 1e-6) << corner;
  }
  EXPECT_GT(scene.scene_radius, 0.5);
  EXPECT_LT(scene.scene_radius, 3);
}

TEST(Instances, InGroupsAreMultipliedOut) {
  const std::string outer = "<shape type='shapegroup' id='outer'>" + instance("<translate x='1'/>") +
                            instance("<translate x='2'/>") + "<shape type='disk'/><shape type='sphere'>" +
                            placed("<scale x='-1'/>") + "</shape></shape>";
  const FlatScene scene = compiled(kGroup + outer + instance("<scale value='2'/>", "outer") +
                                   instance("<scale x='-1'/>", "outer"));
  EXPECT_EQ(scene.groups.size(), 1u);
  EXPECT_EQ(scene.instances.size(), 4u);
  ASSERT_EQ(scene.shapes.size(), 12u);
  EXPECT_EQ(scene.shapes[0].type, KB_SHAPE_DISK);
  EXPECT_EQ(scene.shapes[0].to_world[0], 2);
  // Seen from inside, as its own transform says; its instance's does not turn it.
  EXPECT_TRUE(scene.shapes[1].flags & KB_SHAPE_FLIP_NORMALS);
  EXPECT_TRUE(scene.shapes[7].flags & KB_SHAPE_FLIP_NORMALS);
  EXPECT_NEAR(vertex(scene, scene.shapes[4], 0).x - vertex(scene, scene.shapes[2], 0).x, 2, 1e-4);
  EXPECT_TRUE(scene.shapes[8].flags & KB_SHAPE_MIRRORED);
}

const std::string kGlass =
    "<shape type='shapegroup' id='g'><shape type='cube' id='ice'><bsdf type='dielectric'/></shape></shape>";
const std::string kAir =
    "<medium type='absorbing' name='atmosphere'><spectrum name='absorption' value='0.5'/></medium>";

// They may stand in each other. Without gas nobody asks.
TEST(Instances, OfGlassHaveAnInsideEach) {
  const std::string three =
      kGlass + instance("<scale value='3'/>") + instance("<scale value='2'/>") + instance("");
  const FlatScene scene = compiled(kAir + three);
  ASSERT_EQ(scene.interiors.size(), 3u);
  EXPECT_EQ(scene.interiors, (std::vector<uint32_t>{1, 2, 3}));
  ASSERT_EQ(scene.media.size(), 4u);
  for (const uint32_t m : scene.interiors) EXPECT_EQ(scene.media[m].type, uint32_t{KB_MEDIUM_EMPTY});
  const FlatScene empty = compiled(three);
  EXPECT_TRUE(empty.media.empty() && empty.interiors.empty());
  const FlatScene opaque = compiled(kAir + kGroup + instance("") + instance("<scale value='2'/>"));
  EXPECT_EQ(opaque.media.size(), 1u);
  EXPECT_EQ(opaque.interiors, std::vector<uint32_t>(4, KB_NONE));
}

// 65,534 numbers are one for the atmosphere and those of 65,533 instances.
TEST(Instances, ShareAnInsideWhereNumbersEnd) {
  std::string row = "<shape type='shapegroup' id='row'>", rows, more;
  for (int i = 0; i < 256; ++i) row += instance("");
  for (int i = 0; i < 255; ++i) rows += instance("", "row");
  for (int i = 0; i < 253; ++i) more += instance("");
  Messages messages;
  const std::string most = kAir + kGlass + row + "</shape>" + rows + more;
  const FlatScene parted = compiled(most, messages.lines());
  EXPECT_EQ(parted.media.size(), 65534u);
  EXPECT_EQ(parted.interiors.back(), 65533u);
  EXPECT_TRUE(messages.texts.empty());
  const FlatScene shared = compiled(most + instance(""), messages.lines());
  EXPECT_EQ(shared.interiors, std::vector<uint32_t>(65534, 1));
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_NE(
      messages.texts[0].find(
          "warning: shape 'ice': more than 65534 media and shapes that transmit light: instances of one "
          "shape count as one body, which is wrong where they stand in each other"),
      std::string::npos);
}

}  // namespace
}  // namespace kiloband::test::instances_test
