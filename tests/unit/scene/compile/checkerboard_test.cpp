// Checkerboards as kernels find them.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::checkerboard_test {
namespace {

std::shared_ptr<const FlatScene> compiled(const std::string& body) {
  const ChannelList channels = parse_channels("500-510, 600-610");
  return compile_scene(read_scene_text(scene_around(body), "scene.xml", "."), {channels, channels, {}});
}

// A wall and a lamp with the same board: what the lamp emits is in units of its own (channel_scale).
TEST(CompiledCheckerboard, LampsAndWallsHaveRowsOfTheirOwn) {
  const std::string board =
      "<texture type='checkerboard' id='board'><spectrum name='color0' value='0.5'/><spectrum name='color1' value='0.25'/></texture>";
  const std::string wall =
      "<shape type='cube'><bsdf type='diffuse'><ref name='reflectance' id='board'/></bsdf></shape>";
  const std::string lamp =
      "<shape type='cube'><emitter type='area'><ref name='radiance' id='board'/></emitter></shape>";
  EXPECT_EQ(compiled(board + wall + wall + "<emitter type='constant'/>")->checkerboards.size(), 1u);
  const auto both = compiled(board + wall + lamp);
  ASSERT_EQ(both->checkerboards.size(), 2u);
  EXPECT_NE(both->checkerboards[0].ref0, both->checkerboards[1].ref0);
}

// One ray: all of the film's only pixel looks along the axis.
TEST(CompiledCamera, RadianceMetersHaveNoExtent) {
  const auto scene = compile_scene(
      read_scene_text(
          "<scene version='3.0.0'><emitter type='constant'/><sensor type='radiancemeter'><film type='hdrfilm'>"
          "<integer name='width' value='1'/><integer name='height' value='1'/></film></sensor></scene>",
          "scene.xml", "."),
      {parse_channels("500-510"), parse_channels("500-510"), {}});
  EXPECT_EQ(scene->camera.tan_half_fov_x, 0);
}

}  // namespace
}  // namespace kiloband::test::checkerboard_test
