// Places and sizes that single precision cannot take are errors, scenes larger than 10^4 m a warning.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::place_limits_test {
namespace {

const std::string kCamera = "<sensor type='perspective'/>";
const std::string kSky = "<emitter type='constant'/>";

std::string moved(const std::string& shape, const std::string& steps) {
  return "<shape type='" + shape + "'><transform name='to_world'>" + steps + "</transform></shape>";
}

TEST(PlaceLimits, HaveTheirMessages) {
  const std::string ball = "<shape type='sphere'/>", pose = "<transform name='to_world'>";
  const std::pair<std::string, const char*> cases[] = {
      {kCamera + kSky + "<shape type='sphere' id='ball'><point name='center' value='0 1e19 0'/></shape>",
       "error: shape 'ball': y = 1e+19 m: must be within 1e+09 m of the origin"},
      {kCamera + kSky + moved("cube", "<translate z='-1e19'/>"),
       "error: shape: z = -1e+19 m: must be within 1e+09 m of the origin"},
      {kCamera + kSky + moved("rectangle", "<scale value='1e30'/>"),
       "error: shape: x = -1e+30 m: must be within 1e+09 m of the origin"},
      {kCamera + kSky + "<shape type='cylinder'><float name='radius' value='1e12'/></shape>",
       "error: shape: x = -1e+12 m: must be within 1e+09 m of the origin"},
      {kCamera + kSky + moved("disk", "<scale value='1e-30'/>"),
       "error: shape: a size of 1e-30 m: must be from 1e-09 to 1e+09 m"},
      {kSky + ball + "<sensor type='perspective'>" + pose + "<translate x='1e19'/></transform></sensor>",
       "error: sensor: x = 1e+19 m: must be within 1e+09 m of the origin"},
      {kSky + ball + "<sensor type='orthographic'>" + pose + "<scale value='1e-30'/></transform></sensor>",
       "error: sensor: a size of 1e-30 m: must be from 1e-09 to 1e+09 m"},
      {kCamera + ball + "<emitter type='point' id='lamp'><point name='position' value='0 0 1e19'/></emitter>",
       "error: emitter 'lamp': z = 1e+19 m: must be within 1e+09 m of the origin"},
      {kCamera + ball + "<emitter type='spot'>" + pose + "<translate y='1e19'/></transform></emitter>",
       "error: emitter: y = 1e+19 m: must be within 1e+09 m of the origin"},
      {kCamera + kSky +
           "<shape type='cube'><bsdf type='null'/><medium type='plume' id='fire' name='interior'><string "
           "name='field' "
           "value='jet'/><spectrum name='absorption' value='1'/><float name='temperature' "
           "value='900'/><float "
           "name='ambient' value='300'/><float name='radius' value='1'/><float name='length' value='1'/>" +
           pose + "<translate x='1e30'/></transform></medium></shape>",
       "error: medium 'fire': x = 1e+30 m: must be within 1e+09 m of the origin"},
  };
  for (const auto& [body, message] : cases) EXPECT_EQ(flattened(body), message) << body;
}

TEST(PlaceLimits, LargeScenesAreWarnedOf) {
  const auto apart = [](const std::string& metres) {
    return kCamera + kSky + "<shape type='sphere'/>" + moved("cube", "<translate x='" + metres + "'/>");
  };
  EXPECT_EQ(flattened(apart("9900")), "");
  EXPECT_EQ(
      flattened(apart("50000")),
      "parts of the scene are 5e+04 m apart, more than 10000 m: single precision loses details smaller than "
      "0.095 m");
  // Far from the origin, near each other: moved there, no loss.
  const std::string there = "<translate x='500000'/>";
  EXPECT_EQ(flattened(kSky + moved("cube", there) + "<sensor type='perspective'><transform name='to_world'>" +
                      there + "</transform></sensor>"),
            "");
}

/// What shapes of a formula take of space: a cylinder is as long as from end to end, a disk has no thickness.
TEST(PlaceLimits, ShapesAreAsLargeAsTheyAre) {
  const auto with = [](const std::string& shape) { return flattened(kCamera + kSky + shape); };
  const std::string cylinder =
      "<shape type='cylinder'><float name='radius' value='1'/><point name='p1' value='0 0 ";
  EXPECT_EQ(with(cylinder + "9000'/></shape>"), "");
  EXPECT_NE(with(cylinder + "11000'/></shape>"), "");
  EXPECT_EQ(with(moved("sphere", "<scale value='4900'/>")), "");
  EXPECT_NE(with(moved("sphere", "<scale value='5100'/>")), "");
  EXPECT_EQ(with(moved("disk", "<scale value='4900'/>") + "<shape type='sphere'><transform name='to_world'>"
                                                          "<translate z='9000'/></transform></shape>"),
            "");
}

}  // namespace
}  // namespace kiloband::test::place_limits_test
