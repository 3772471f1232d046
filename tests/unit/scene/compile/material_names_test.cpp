// What materials are called in `kiloband info` and `kiloband trace`.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::material_names_test {
namespace {

std::vector<std::string> names_of(const std::string& bsdf) {
  const ChannelList channels = parse_channels("500-510");
  const std::string scene = "<scene version='3.0.0'><shape type='sphere'>" + bsdf +
                            "</shape><emitter type='constant'/><sensor type='perspective'/></scene>";
  return compile_scene(read_scene_text(scene, "scene.xml", "."), {channels, channels, {}})->material_names;
}

using Names = std::vector<std::string>;

TEST(MaterialNames, OwnIdThenThatOfWhatItIsNestedInThenANumber) {
  EXPECT_EQ(names_of("<bsdf type='diffuse' id='wall'/>"), Names{"wall"});
  EXPECT_EQ(names_of("<bsdf type='twosided' id='leaf'><bsdf type='diffuse'/></bsdf>"), Names{"leaf"});
  EXPECT_EQ(names_of("<bsdf type='twosided' id='leaf'><bsdf type='diffuse' id='green'/></bsdf>"),
            Names{"green"});
  EXPECT_EQ(names_of("<bsdf type='mask' id='net'><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf>"),
            Names{"net"});
  EXPECT_EQ(names_of("<bsdf type='twosided'><bsdf type='diffuse'/><bsdf type='plastic'/></bsdf>"),
            (Names{"material 0", "material 1"}));
}

}  // namespace
}  // namespace kiloband::test::material_names_test
