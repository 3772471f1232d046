// Scenes far from their origin are moved to it; what stands there keeps its coordinates.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::place_test {
namespace {

/// A cube of half side 1, a ball, a point light and a camera about (x, 0, 0).
FlatScene place(const std::string& x) {
  const std::string at = "<translate x='" + x + "'/>";
  const std::string scene =
      "<scene version='3.0.0'><shape type='cube'><transform name='to_world'>" + at +
      "</transform></shape><shape type='sphere'><float name='radius' value='0.5'/><transform "
      "name='to_world'>" +
      at + "<translate y='2'/></transform></shape><emitter type='point'><point name='position' x='" + x +
      "' y='0' z='3'/></emitter><sensor type='perspective'><transform name='to_world'>" + at +
      "<translate z='5'/></transform></sensor></scene>";
  const ChannelList channels = parse_channels("500-510");
  return *compile_scene(read_scene_text(scene, "scene.xml", "."), {channels, channels, {}});
}

TEST(Place, SceneInMapCoordinatesIsMoved) {
  const FlatScene near = place("0"), far = place("1000000.3");
  EXPECT_EQ(near.origin, (std::array<double, 3>{0, 0, 0}));
  EXPECT_NEAR(far.origin[0], 1000000.3, 2e-10);
  // The difference of two floats near 10^6 would be a multiple of 1/16.
  const double y = far.origin[1];
  ASSERT_EQ(near.positions.size(), far.positions.size());
  for (std::size_t i = 0; i + 1 < near.positions.size(); ++i) {
    EXPECT_NEAR(far.positions[i].x, near.positions[i].x, 2e-10);  // 10^6 in double
    EXPECT_NEAR(far.positions[i].y, near.positions[i].y - y, 1e-6);
  }
  EXPECT_NEAR(far.shapes[1].to_world[3], 0, 2e-10);
  EXPECT_NEAR(far.shapes[1].to_object[3], 0, 4e-10);
  EXPECT_NEAR(far.emitters[0].to_world[3], 0, 2e-10);
  EXPECT_EQ(far.emitters[0].to_world[11], 3 - static_cast<float>(far.origin[2]));
  EXPECT_NEAR(far.camera.to_world[3], 0, 2e-10);
  EXPECT_NEAR(far.camera.to_world[11], 5 - far.origin[2], 1e-6);
}

/// Up to 32 times its own half diagonal away a scene stays where it is.
TEST(Place, SceneNearTheOriginKeepsItsCoordinates) {
  const FlatScene scene = place("60");
  EXPECT_EQ(scene.origin, (std::array<double, 3>{0, 0, 0}));
  EXPECT_EQ(scene.camera.to_world[3], 60);
  EXPECT_NE(place("90").origin[0], 0);
}

}  // namespace
}  // namespace kiloband::test::place_test
