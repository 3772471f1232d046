// Principled materials as kernels and lanes find them.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::principled_test {
namespace {

std::shared_ptr<const FlatScene> compiled(const std::string& bsdfs,
                                          const std::filesystem::path& folder = ".") {
  const ChannelList channels = parse_channels("500-510, 600-610");
  std::string shapes;
  for (std::size_t at = 0; at < bsdfs.size();) {
    const std::size_t end = bsdfs.find(';', at);
    shapes += "<shape type='sphere'>" + bsdfs.substr(at, end - at) + "</shape>";
    at = end + 1;
  }
  const std::string scene =
      "<scene version='3.0.0'>" + shapes + "<emitter type='constant'/><sensor type='perspective'/></scene>";
  return compile_scene(read_scene_text(scene, "scene.xml", folder), {channels, channels, {}});
}

/// A row for every material, so that kernels for any scene may look; none in scenes without such materials.
TEST(CompiledPrincipled, EveryMaterialHasARowOfMaps) {
  const auto plain = compiled("<bsdf type='diffuse'/>;");
  EXPECT_TRUE(plain->principled_maps.empty());
  EXPECT_FALSE(plain->features.principled);
  const auto numbers = compiled("<bsdf type='diffuse'/>;<bsdf type='principled'/>;<bsdf type='plastic'/>;");
  EXPECT_EQ(numbers->principled_maps, std::vector<uint32_t>(3 * KB_PRINCIPLED_MAPPED, KB_NONE));
  EXPECT_TRUE(numbers->features.principled);
  EXPECT_FALSE(numbers->features.principled_map);
  const TemporaryFolder folder;
  folder.write("map.pgm", "P2\n1 1\n255\n128\n");
  const auto mapped = compiled(
      "<bsdf type='diffuse'/>;<bsdf type='principled'><texture type='bitmap' name='sheen'><string name='filename' "
      "value='map.pgm'/></texture></bsdf>;",
      folder.path());
  EXPECT_TRUE(mapped->features.principled_map);
  for (uint32_t i = 0; i < 2 * KB_PRINCIPLED_MAPPED; ++i)
    EXPECT_EQ(mapped->principled_maps[i] != KB_NONE, i == KB_PRINCIPLED_MAPPED + KB_PRINCIPLED_SHEEN) << i;
}

/// The luminance of a tint is that of the spectrum under D65; without tints there is none.
TEST(CompiledPrincipled, NumbersAreATable) {
  const auto scene = compiled(
      "<bsdf type='principled'><rgb name='base_color' value='0.7, 0.4, 0.2'/><float name='spec_tint' "
      "value='0.5'/><float name='metallic' value='0.25'/></bsdf>;<bsdf type='principled'/>;");
  const float* table = &scene->tables[scene->materials[0].table];
  EXPECT_EQ(table[KB_PRINCIPLED_METALLIC], 0.25f);
  EXPECT_NEAR(table[KB_PRINCIPLED_LUMINANCE], 0.212671 * 0.7 + 0.715160 * 0.4 + 0.072169 * 0.2, 0.005);
  EXPECT_EQ(scene->tables[scene->materials[1].table + KB_PRINCIPLED_LUMINANCE], 0);
  EXPECT_EQ(scene->materials[0].bound_b, 1);
}

}  // namespace
}  // namespace kiloband::test::principled_test
