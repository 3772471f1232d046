// Scenes in which paths could live for ever or values leave the range of floats:
// none may produce an invalid sample.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/render_harness.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test::test_hard_scenes {
namespace {

using namespace scene_text;

/// A folder with a 2x2 picture of dark blue, red, green and one white texel.
class HardScenes : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("picture.ppm", "P6\n2 2\n255\n\x20\x20\x60\x60\x20\x20\x20\x60\x20\xff\xff\xff");
    spec_.directory = folder_.path();
    spec_.spp = 32;
    spec_.bands = "450:650:4";
  }

  /// A closed cube around the camera with a small lamp in it, unlimited depth.
  RenderResult render_cavity(const std::string& walls) {
    spec_.xml = scene(
        -1, perspective(lookat("0, 0, 0.5", "0, 0, -1"), 60, film(16)) + shape("cube", kInwards + walls) +
                shape("sphere",
                      real("radius", 0.2) + number("point", "center", "0.3, 0.6, 0") + diffuse(0) + lamp(1)));
    return render(spec_);
  }

  TemporaryFolder folder_;
  RenderSpec spec_;
};

void expect_sound(const RenderResult& result, double longest_mean_path) {
  EXPECT_EQ(result.invalid_samples, 0u);
  EXPECT_LT(static_cast<double>(result.vertices) / static_cast<double>(result.paths), longest_mean_path);
  for (const double value : result.mean) ASSERT_TRUE(std::isfinite(value));
  for (const double value : result.variance) ASSERT_TRUE(std::isfinite(value));
}

// Roulette must see the texel that is hit: with the bound of the whole picture, 1 for its white texel,
// no path would end.
TEST_F(HardScenes, PathsEndBetweenTexturedWallsWithOneWhiteTexel) {
  expect_sound(
      render_cavity(bsdf("diffuse", bitmap("reflectance", "picture.ppm", "repeat", "nearest", scale("1")))),
      100);  // a quarter of the walls is white: paths are long, but far from the limit of 100000
}

TEST_F(HardScenes, PathsEndBetweenCheckerboards) {
  expect_sound(
      render_cavity(bsdf("diffuse", texture("checkerboard", "reflectance",
                                            spectrum("color0", 1) + spectrum("color1", 0.1), scale("1")))),
      40);
}

// F is about 0.9 for n = 0.25, k = 3: roulette's bound must know it,
// and long chains of cosines are no overflow.
TEST_F(HardScenes, PathsEndInMetalCavities) {
  const std::string metal = spectrum("eta", 0.25) + spectrum("k", 3);
  expect_sound(render_cavity(bsdf("conductor", metal)), 200);
  expect_sound(render_cavity(bsdf("roughconductor", real("alpha", 0.3) + metal)), 200);
}

// A line 0.2 nm wide in a channel where everything else is 1e-96: channel scales follow the line.
TEST_F(HardScenes, NarrowLineOverPlanckAt200KStaysFinite) {
  spec_.bands = "300-400";
  spec_.spp = 8192;  // one wavelength in 500 meets the line
  const std::string cold =
      "<spectrum name='radiance' type='planck'>" + real("temperature", 200) + "</spectrum>";
  spec_.xml = scene(-1, perspective(lookat("0, 0, 3", "0, 0, 0"), 60, film(8)) + shape("sphere", "") +
                            emitter("constant", cold) +
                            emitter("point", number("point", "position", "0, 0, 3") +
                                                 spectrum("intensity", "331:0, 331.1:1, 331.2:0")));
  const RenderResult result = render(spec_);
  expect_sound(result, 10);
  EXPECT_GT(result.image_mean[0], 0);
  EXPECT_LT(result.image_mean[0], 1);
}

// A coloured opacity picture counts by the luminance of its colour, not by the scale of its upsampled spectrum.
TEST_F(HardScenes, ColouredOpacityIsItsLuminance) {
  folder_.write("red.ppm", std::string("P6\n1 1\n255\n\xff\0\0", 14));
  spec_.spp = 256;
  const std::string holes =
      "<texture type='bitmap' name='opacity'>" + text("filename", "red.ppm") + "</texture>";
  spec_.xml = scene(-1, perspective(lookat("0, 0, 3", "0, 0, 0"), 10, film(16)) +
                            shape("rectangle", bsdf("mask", holes + diffuse(0))) + sky(1));
  const RenderResult result = render(spec_);
  // One number per pixel sample decides: 65536 of them with probability 0.787; 5 standard errors are 0.008.
  EXPECT_NEAR(result.image_mean[0] / 50, 1 - 0.212671, 0.01);  // channels are 50 nm wide
}

}  // namespace
}  // namespace kiloband::test::test_hard_scenes
