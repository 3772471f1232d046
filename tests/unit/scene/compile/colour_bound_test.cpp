// Bounds of texels of colours, which decide how long paths go on.
#include <gtest/gtest.h>

#include <algorithm>

#include "scene/compile/flat_scene.hpp"
#include "spectral/colour/colour.hpp"
#include "spectral/colour/rgb.hpp"
#include "support.hpp"

namespace kiloband::test::colour_bound_test {
namespace {

/// Against the spectra of the same colours as the materials' own solver has them, which is as exact as doubles are; texels come from
/// a table and are within 1e-3. With bounds too low, images stay right in the mean, and paths become thousands of times as long or
/// carry weights that large.
TEST(ColourBounds, AreTheLargestValueInTheChannels) {
  const int colours[][3] = {{200, 90, 40}, {60, 180, 90},  {40, 70, 190},
                            {250, 10, 10}, {230, 220, 30}, {128, 128, 128}};
  const TemporaryFolder folder;
  std::string image = "P3\n6 1\n255\n";
  for (const auto& c : colours)
    image += std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) + "\n";
  folder.write("colours.ppm", image);
  const std::string body = sphere_with(
      "<texture type='bitmap' name='reflectance'><boolean name='raw' value='false'/><string name='filename' value='colours.ppm'/></texture>");
  const SceneDescription description = read_scene_text(scene_around(body), "scene.xml", folder.path(), {});
  for (const auto& [first_nm, last_nm] :
       {std::pair{400, 420}, {500, 560}, {400, 700}, {690, 700}, {300, 1000}}) {
    const ChannelList channels = parse_channels(std::to_string(first_nm) + "-" + std::to_string(last_nm));
    const auto scene = compile_scene(description, {channels, channels, {}});
    ASSERT_EQ(scene->texel_bounds.size(), 6u);
    for (int i = 0; i < 6; ++i) {
      SCOPED_TRACE(testing::Message() << "colour " << i << ", " << first_nm << " to " << last_nm << " nm");
      const auto linear = [&](int c) { return static_cast<float>(srgb_decode(colours[i][c] / 255.0)); };
      const Spectrum spectrum = rgb_reflectance({linear(0), linear(1), linear(2)});
      double largest = 0;
      for (double nm = first_nm; nm <= last_nm; nm += 0.5) largest = std::max(largest, spectrum(nm));
      EXPECT_NEAR(scene->texel_bounds[i], largest, 0.01);
    }
  }
}

}  // namespace
}  // namespace kiloband::test::colour_bound_test
