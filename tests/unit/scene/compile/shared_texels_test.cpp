// Texels of images that several textures have: solved and kept once, and those of all colours as if each were solved by itself.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "scene/compile/flat_scene.hpp"
#include "support.hpp"

namespace kiloband::test::shared_texels_test {
namespace {

std::string bitmap(const std::string& name, const std::string& file, const std::string& more = "") {
  return "<texture type='bitmap' name='" + name + "'><string name='filename' value='" + file + "'/>" + more +
         "</texture>";
}

std::string sphere(const std::string& reflectance) {
  return "<shape type='sphere'><bsdf type='diffuse'>" + reflectance + "</bsdf></shape>";
}

/// width x 1 texels of 8 bits a component.
std::string picture(const std::vector<std::array<int, 3>>& colours) {
  std::string text = "P3\n" + std::to_string(colours.size()) + " 1\n255\n";
  for (const auto& [r, g, b] : colours)
    text += std::to_string(r) + " " + std::to_string(g) + " " + std::to_string(b) + "\n";
  return text;
}

bool equal(const KbFloat4& a, const KbFloat4& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

class SharedTexels : public testing::Test {
 protected:
  std::shared_ptr<const FlatScene> compiled(const std::string& body) const {
    const ChannelList channels = parse_channels("400-700");
    return compile_scene(read_scene_text(scene_around(body), "scene.xml", folder_.path(), {}),
                         {channels, channels, {}});
  }

  const TemporaryFolder folder_;
};

TEST_F(SharedTexels, OfOneImageStandOnceForEveryUse) {
  folder_.write("a.ppm", picture({{200, 90, 40}, {60, 180, 90}, {40, 70, 190}}));
  const std::string once = sphere(bitmap("reflectance", "a.ppm"));
  const std::string clamped =
      sphere(bitmap("reflectance", "a.ppm", "<string name='wrap_mode' value='clamp'/>"));
  const std::string shades = "<shape type='sphere'><bsdf type='roughconductor'>" +
                             bitmap("alpha", "a.ppm", "<boolean name='raw' value='true'/>") +
                             "</bsdf></shape>";
  const std::string lamp =
      "<shape type='rectangle'><emitter type='area'>" + bitmap("radiance", "a.ppm") + "</emitter></shape>";
  const std::string light = "<emitter type='constant'/>";
  const auto scene = compiled(once + once + clamped + shades + lamp + light);
  ASSERT_EQ(scene->textures.size(), 5u);
  EXPECT_EQ(scene->texels.size(), 6u);        // as reflectances and as emission
  EXPECT_EQ(scene->texel_bounds.size(), 9u);  // and as roughnesses
  for (int i : {1, 2}) EXPECT_EQ(scene->textures[i].first_texel, scene->textures[0].first_texel);
  EXPECT_NE(scene->textures[2].wrap, scene->textures[0].wrap);
  EXPECT_EQ(scene->textures[3].flags, KB_TEXTURE_NUMBERS);
  EXPECT_NE(scene->textures[3].first_bound, scene->textures[0].first_bound);
  EXPECT_NE(scene->textures[4].first_texel, scene->textures[0].first_texel);
}

/// Its scale is in its texels, which a lamp with the same image must not get.
TEST_F(SharedTexels, OfAnEnvironmentAreItsOwn) {
  folder_.write("b.ppm", "P3\n2 2\n255\n200 90 40 60 180 90\n10 20 30 40 50 60\n");
  const std::string lamp =
      "<shape type='rectangle'><emitter type='area'>" + bitmap("radiance", "b.ppm") + "</emitter></shape>";
  const std::string sky =
      "<emitter type='envmap'><string name='filename' value='b.ppm'/><float name='scale' value='8'/></emitter>";
  const auto alone = compiled(lamp), both = compiled(lamp + sky), turned = compiled(sky + lamp);
  ASSERT_EQ(alone->texels.size(), 4u);
  const auto lamp_texels = [](const FlatScene& scene) {
    for (const KbTexture& texture : scene.textures)
      if (!(texture.flags & KB_TEXTURE_ENVMAP)) return &scene.texels[texture.first_texel];
    return static_cast<const KbFloat4*>(nullptr);
  };
  for (const auto& scene : {both, turned}) {
    ASSERT_EQ(scene->texels.size(), 8u);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(equal(lamp_texels(*scene)[i], alone->texels[i])) << i;
  }
}

/// Colours of which some are kept in the same places, and many come again: each texel and bound has the bits of an image of it alone.
TEST_F(SharedTexels, HaveTheBitsOfTexelsByThemselves) {
  const std::string light = "<emitter type='constant'/>";
  std::mt19937 random(7);
  std::vector<std::array<int, 3>> colours;
  const auto component = [&] { return static_cast<int>(random() % 256); };
  for (int i = 0; i < 300; ++i) {
    if (i % 3 == 2)
      colours.push_back(colours[random() % colours.size()]);
    else
      colours.push_back({component(), component(), component()});
  }
  folder_.write("all.ppm", picture(colours));
  const auto all = compiled(sphere(bitmap("reflectance", "all.ppm")) + light);
  ASSERT_EQ(all->texels.size(), colours.size());
  for (std::size_t i = 0; i < colours.size(); i += 7) {
    folder_.write("one.ppm", picture({colours[i]}));
    const auto one = compiled(sphere(bitmap("reflectance", "one.ppm")) + light);
    EXPECT_TRUE(equal(all->texels[i], one->texels[0])) << i;
    EXPECT_EQ(all->texel_bounds[i], one->texel_bounds[0]) << i;
  }
}

}  // namespace
}  // namespace kiloband::test::shared_texels_test
