// <shape type="shapegroup"> and <shape type="instance">.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_instances {
namespace {

std::string group(const std::string& contents, const std::string& id = "g") {
  return R"(<shape type="shapegroup" id=")" + id + R"(">)" + contents + "</shape>";
}
std::string instance(const std::string& contents) {
  return R"(<shape type="instance">)" + contents + "</shape>";
}
const std::string kCube = R"(<shape type="cube"/>)", kRef = R"(<ref id="g"/>)";
const std::string kStretch = R"(<transform name="to_world"><scale x="2"/></transform>)";

TEST(SceneInstances, ShareTheirGroup) {
  const SceneDescription scene = read(test::scene(
      group(kCube + kSphere) + R"(<shape type="instance" id="first"><ref id="g"/></shape>)" +
      instance(kRef + R"(<transform name="to_world"><translate x="3"/></transform>)") + kSensor + kLight));
  EXPECT_TRUE(scene.shapes.empty());
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].group, scene.instances[1].group);
  EXPECT_EQ(scene.instances[0].id, "first");
  EXPECT_EQ(scene.instances[1].to_world[3].x, 3);
  ASSERT_EQ(scene.instances[0].group->shapes.size(), 2u);
}

TEST(SceneInstances, GroupsMayHaveInstances) {
  const SceneDescription scene = read(test::scene(group(kCube) + group(instance(kRef) + kCube, "outer") +
                                                  instance(R"(<ref id="outer"/>)") + kSensor + kLight));
  ASSERT_EQ(scene.instances.size(), 1u);
  const ShapeGroup& outer = *scene.instances[0].group;
  EXPECT_EQ(outer.shapes.size(), 1u);
  ASSERT_EQ(outer.instances.size(), 1u);
  EXPECT_EQ(outer.instances[0].group->id, "g");
}

// Each is looked at once, however often it is repeated: 16^12 places here.
TEST(SceneInstances, OfInstancesOfInstances) {
  std::string groups = group(kCube, "g0");
  for (int level = 1; level <= 12; ++level) {
    std::string contents;
    for (int i = 0; i < 16; ++i) contents += instance("<ref id='g" + std::to_string(level - 1) + "'/>");
    groups += group(contents, "g" + std::to_string(level));
  }
  const SceneDescription scene =
      read(test::scene(groups + instance("<ref id='g12'/>" + kStretch) + kSensor + kLight));
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_FALSE(scene.instances[0].group->has_analytic_shapes);
}

// A group stands inside its instance, too; without one it is nothing to see.
TEST(SceneInstances, GroupsInPlace) {
  const SceneDescription scene = read(test::scene(instance(group(kCube)) + kSensor + kLight));
  EXPECT_EQ(scene.instances.at(0).group->shapes.size(), 1u);
  EXPECT_TRUE(read(complete_scene(group(kCube))).instances.empty());
}

TEST(SceneInstances, WhatTheyCannot) {
  const std::string
      lamp = R"(<shape type="cube"><emitter type="area"/></shape>)",
      outside = ": write it into the scene, outside the group",
      gas = R"(<medium name="interior" type="absorbing"><spectrum name="absorption" value="1"/></medium>)";
  expect_messages({
      {"lamp", complete_scene(group(lamp)),
       "scene.xml:2:34: error: shape 'g': a shape of a group cannot emit" + outside},
      {"boundary", complete_scene(group(R"(<shape type="cube"><bsdf type="null"/></shape>)")),
       "scene.xml:2:34: error: shape 'g': a shape of a group cannot have a null bsdf" + outside},
      {"medium", complete_scene(group(R"(<shape type="cube"><bsdf type="dielectric"/>)" + gas + "</shape>")),
       "scene.xml:2:34: error: shape 'g': a shape of a group cannot have an interior medium" + outside},
      {"empty", complete_scene(group("")), "scene.xml:2:2: error: shape 'g': has no shapes"},
      {"nested", complete_scene(group(group(kCube, "inner"))),
       "scene.xml:2:34: error: shape 'g': a group in a group: write an instance of it"},
      {"no group", complete_scene(instance(kCube)),
       "scene.xml:2:2: error: instance shape: needs one shape of type 'shapegroup', or a reference to one"},
      {"parameter", complete_scene(group(kCube) + instance(kRef + R"(<bsdf type="diffuse"/>)")),
       "scene.xml:2:98: error: instance shape: a bsdf is not allowed here"},
      {"stretched",
       complete_scene(group(kSphere, "ball") + group(instance(R"(<ref id="ball"/>)")) +
                      instance(kRef + kStretch)),
       "scene.xml:2:190: error: instance shape: to_world must not stretch or shear a group with spheres, disks or "
       "cylinders: use meshes"},
  });
  EXPECT_EQ(error_of(complete_scene(group(kCube) + instance(kRef + kStretch))), "accepted");
}

}  // namespace
}  // namespace kiloband::test::test_instances
