// Depth limits, hidden emitters, very many samples, invalid samples, stopping, auxiliary images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "room_scene.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"

namespace kiloband::test::test_limits {

using namespace cpu;
namespace {

constexpr FilmSize kFilm{16, 16};
constexpr double kWidthNm = 25;  // of the channels of 500:600:4

/// A lamp of radiance 3 that fills the left half of the view,
/// a diffuse wall of reflectance 0.5 in the right half.
std::string lamp_and_wall() {
  return shape("rectangle",
               to_world(step("scale", "x='2' y='4'") + step("translate", "x='-2'")) + lamp("3")) +
         shape("rectangle", to_world(step("scale", "x='2' y='4'") + turn("y", "-60") +
                                     step("translate", "x='1' z='1.7320508'")));
}

RenderSpec limits_spec(int max_depth, bool hide_emitters) {
  RenderSpec spec;
  spec.xml = scene(max_depth, perspective(lookat("0, 0, 4", "0, 0, 0"), 30, film(16)) + lamp_and_wall(),
                   hide_emitters ? yes("hide_emitters") : "");
  spec.spp = 8;
  spec.threads = 1;
  return spec;
}

TEST(Depth, ZeroIsBlack) {
  const RenderResult result = render(limits_spec(0, false));
  EXPECT_EQ(std::ranges::count(result.mean, 0.0), static_cast<std::ptrdiff_t>(result.mean.size()));
  EXPECT_EQ(result.paths, 16u * 16 * 8);
}

TEST(Depth, OneIsEmissionAlone) {
  const RenderResult result = render(limits_spec(1, false));
  for (uint32_t y = 0; y < 16; ++y) {
    EXPECT_NEAR(result.at(2, y, 0), 3 * kWidthNm, 1e-5 * 3 * kWidthNm);
    EXPECT_EQ(result.at(13, y, 0), 0);
  }
}

TEST(Depth, TwoIsDirectLight) {
  const RenderResult one = render(limits_spec(1, false)), two = render(limits_spec(2, false));
  EXPECT_EQ(one.at(2, 8, 0), two.at(2, 8, 0));  // the lamp itself reflects nothing
  EXPECT_GT(two.at(13, 8, 0), 0);
}

TEST(HiddenEmitters, AreInvisibleAndLight) {
  const RenderResult one = render(limits_spec(1, true));
  EXPECT_EQ(std::ranges::count(one.mean, 0.0), static_cast<std::ptrdiff_t>(one.mean.size()));
  const RenderResult hidden = render(limits_spec(2, true)), seen = render(limits_spec(2, false));
  for (uint32_t y = 0; y < 16; ++y) {
    EXPECT_EQ(hidden.at(2, y, 0), 0);
    EXPECT_EQ(hidden.at(13, y, 0), seen.at(13, y, 0));
    EXPECT_GT(hidden.at(13, y, 0), 0);
  }
}

TEST(HiddenEmitters, HideTheSky) {
  RenderSpec spec;
  const std::string parts = perspective(lookat("0, 0, 4", "0, 0, 0"), 30, film(4)) + sky("0.7");
  spec.xml = scene(-1, parts);
  EXPECT_NEAR(render(spec).at(1, 1, 0), 0.7 * kWidthNm, 1e-5);
  spec.xml = scene(-1, parts, yes("hide_emitters"));
  EXPECT_EQ(render(spec).at(1, 1, 0), 0);
}

/// 2^17 samples in each of two replicates, all of the same value, which is not a float: a plain float sum of
/// them would be off by up to 2^17 x 6e-8 = 8e-3 relative. On devices 2^15, where deliveries of one pixel take what their launches
/// take: a plain sum of such numbers is off by 1.5e-4 to 4e-4.
TEST(ManySamples, LoseNothing) {
  RenderSpec spec;
  spec.xml = scene(-1, perspective(lookat("0, 0, 4", "0, 0, 0"), 30, film(1)) + sky("0.7"));
  spec.bands = "500-510.1, 520-523.7, 540-540.3";
  const uint64_t samples = test_backend_name() == "cpu" ? 1u << 18 : 1u << 16;
  spec.spp = samples;
  spec.sampling.replicates = 2;
  spec.threads = 1;
  for (const WavelengthMode mode : {WavelengthMode::kShared, WavelengthMode::kPerPath}) {
    spec.sampling.wavelengths = mode;
    const RenderResult result = render(spec);
    const double width_nm[] = {10.1, 3.7, 0.3};
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(result.mean[c] / (0.7 * width_nm[c]), 1, 1e-6) << "channel " << c;
      EXPECT_LT(std::sqrt(result.variance[c]) / result.mean[c], 1e-6);
    }
    EXPECT_EQ(result.paths, samples);
  }
}

/// A lamp 10^-18 m before a wall: the light of a sample that selects it is beyond floats. Samples that select
/// the directional light instead are worth albedo / pi * E / (selection probability), all the same.
class InvalidSamples : public ::testing::Test {
 protected:
  InvalidSamples() {
    const std::string parts =
        object("sensor", "orthographic",
               to_world(scale("1e-9") + lookat("0, 0, 1", "0, 0, 0")) + film_text({4, 4})) +
        shape("rectangle", "") +
        emitter("point", number("point", "position", "0, 0, 1e-18") + spectrum("intensity", 1)) +
        emitter("directional", number("vector", "direction", "0, 0, -1") + spectrum("irradiance", 2));
    spec_.xml = scene(2, parts);
    spec_.spp = 64;
    spec_.threads = 1;
    spec_.sampling.sampler = SamplerType::kIndependent;
  }
  RenderSpec spec_;
};

TEST_F(InvalidSamples, AreCountedAndLeaveTheMean) {
  const RenderResult result = render(spec_);
  ASSERT_GT(result.invalid_samples, 0u);
  ASSERT_LT(result.invalid_samples, result.paths);
  const double expected = 0.5 / std::numbers::pi * 2 / result.scene.emitters[1].select_pdf * kWidthNm;
  for (const double mean : result.mean) EXPECT_NEAR(mean, expected, 1e-5 * expected);
  for (const double variance : result.variance) EXPECT_LT(variance, 1e-10 * expected * expected);
}

TEST_F(InvalidSamples, LeaveTheSampleCountAndAreListed) {
  const SceneDescription description = read_scene_text(spec_.xml, "test.xml", ".", {});
  const auto scene = compile_scene(description, {parse_channels("500:600:4"), {}, {}});
  SamplingSettings sampling = spec_.sampling;
  sampling.replicates = 2;
  const auto backend = cpu::make_backend(scene, {}, sampling, {Isa::kAuto, 1});
  SpectralFilm film({0, 0, 4, 4}, {4, 2, true, false});
  for (uint32_t r = 0; r < 2; ++r) backend->render(film, {r, 0, 32}, {0}, false, {});
  uint64_t samples = 0;
  for (uint32_t i = 0; i < 16; ++i) samples += film.samples(i % 4, i / 4);
  EXPECT_EQ(samples + backend->statistics().invalid_samples, 16u * 64);
  const std::vector<InvalidSample> listed = backend->statistics().first_invalid;
  ASSERT_FALSE(listed.empty());
  EXPECT_LE(listed.size(), 16u);
  for (const InvalidSample& sample : listed) EXPECT_TRUE(sample.x < 4 && sample.y < 4 && sample.sample < 64);
}

TEST(Stopping, DeliversWhatIsDone) {
  const SceneDescription description = read_scene_text(room_spec({40, 40}).xml, "test.xml", ".", {});
  const auto scene = compile_scene(description, {parse_channels("500:600:4"), {}, {}});
  SamplingSettings sampling;
  sampling.replicates = 1;
  const auto backend = cpu::make_backend(scene, {}, sampling, {Isa::kAuto, 1});
  SpectralFilm film({0, 0, 40, 40}, {4, 1, true, true});
  std::atomic<bool> stop{false};
  uint64_t reported = 0;
  backend->render(film, {0, 0, 1000}, {0, 1, 2, 3}, stop, [&](uint64_t pixel_samples) {
    reported += pixel_samples;
    stop = reported >= 3 * 32 * 32;
  });
  EXPECT_EQ(reported, 3u * 32 * 32);  // three samples of the first block
  EXPECT_EQ(film.samples(0, 0), 3u);
  EXPECT_EQ(film.samples(39, 39), 0u);
  EXPECT_EQ(backend->statistics().paths, reported);
}

TEST(AuxiliaryImages, ShowTheNearestSurface) {
  // Orthographic: pixel centres at x = -0.75, -0.25, 0.25, 0.75 from right to left in the camera's frame.
  const std::string parts =
      object("sensor", "orthographic", to_world(lookat("0, 0, 5", "0, 0, 0")) + film_text({4, 4})) +
      shape("sphere", number("point", "center", "-0.25, 0.25, 1") + real("radius", 0.2)) +
      shape("rectangle", translate(-1, 0, 0), bsdf("twosided", bsdf("diffuse") + bsdf("plastic"))) +
      emitter("constant", "");
  const SceneDescription description = read_scene_text(scene_text::scene(-1, parts), "test.xml", ".", {});
  const auto scene = compile_scene(description, {parse_channels("500:600:4"), {}, {}});
  const auto backend = cpu::make_backend(scene, {}, {}, {Isa::kAuto, 1});
  const std::vector<AuxiliaryPixel> pixels = backend->auxiliary({0, 0, 4, 4});
  ASSERT_EQ(pixels.size(), 16u);

  const AuxiliaryPixel& ball = pixels[1 * 4 + 1];  // its middle
  EXPECT_NEAR(ball.depth, 3.8, 1e-4);
  EXPECT_NEAR(ball.normal.z, 1, 1e-4);
  EXPECT_EQ(ball.object, 0);
  const AuxiliaryPixel& wall = pixels[2 * 4 + 0];
  EXPECT_NEAR(wall.depth, 5, 1e-4);
  EXPECT_NEAR(wall.normal.z, 1, 1e-6);
  EXPECT_EQ(wall.object, 1);
  EXPECT_EQ(wall.material, scene->surfaces[scene->shapes[1].surface].front);
  const AuxiliaryPixel& nothing = pixels[3];
  EXPECT_EQ(nothing.depth, 0);
  EXPECT_EQ(nothing.object, -1);
  EXPECT_EQ(nothing.material, -1);
  // Part of the image alone.
  const std::vector<AuxiliaryPixel> part = backend->auxiliary({1, 1, 2, 1});
  ASSERT_EQ(part.size(), 2u);
  EXPECT_EQ(part[0].depth, ball.depth);
}

}  // namespace
}  // namespace kiloband::test::test_limits
