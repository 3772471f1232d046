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

/// Gold as a glass rendered as clear glass, silently.
TEST(MaterialNames, GlassThatIsOpaqueIsWarnedOf) {
  const TemporaryFolder folder;
  folder.write("gold.csv", "nm,n,k\n400,1.5,0.001\n450,1.5,0.002\n600,0.25,3.1\n700,0.2,3.5\n");
  const std::string scene =
      "<scene version='3.0.0'><shape type='sphere'><bsdf type='dielectric'><string name='int_material' "
      "value='gold.csv'/></bsdf></shape><emitter type='constant'/><sensor type='perspective'/></scene>";
  const SceneDescription description = read_scene_text(scene, "scene.xml", folder.path());
  const auto told = [&](const std::string& bands) {
    Messages messages;
    const ChannelList channels = parse_channels(bands);
    compile_scene(description, {channels, channels, messages.lines()});
    return messages.texts;
  };
  EXPECT_EQ(told("410-420"), Names{});
  ASSERT_EQ(told("590-600").size(), 1u);
  EXPECT_NE(
      told("590-600")[0].find("int_material: its extinction k, up to 3.1 in the channels, has no effect: "
                              "nothing absorbs inside; a conductor takes the file as 'metal'"),
      std::string::npos);
}

}  // namespace
}  // namespace kiloband::test::material_names_test
