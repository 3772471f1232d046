// What flattening makes of spectral images: bounds, means, the choice of lights
// and directions, channel scales.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scene/compile/flat_scene.hpp"
#include "support.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/envmap_table.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::spectral_flatten_test {

using namespace cpu;
namespace {

FlatScene flat(const std::string& body, const TemporaryFolder& folder, const std::string& bands,
               const DiagnosticSink& sink = {}) {
  const SceneDescription description = read_scene_text(scene_around(body), "scene.xml", folder.path(), {});
  return *compile_scene(description, {parse_channels(bands), {}, sink});
}

std::string bitmap(const std::string& file, const std::string& more = "") {
  return sphere_with("<texture type='spectral_bitmap' name='reflectance'><string name='filename' value='" +
                     file + "'/>" + more + "</texture>");
}

const ChannelList kBands{{400, 420, ""}, {420, 480, ""}, {480, 600, ""}};

/// Bounds count the bands that channels see: channels of 425-435 see those at 410 and 450, not that at 540.
TEST(SpectralFlatten, BoundsAndMeansOfBands) {
  const TemporaryFolder folder;
  write_cube(folder / "a.exr", 2, 1, kBands, [](uint32_t x, uint32_t, std::size_t b) {
    const double values[2][3] = {{0.1, 0.4, 0.9}, {0.3, 0.2, 1}};
    return values[x][b];
  });
  const FlatScene scene = flat(bitmap("a.exr"), folder, "425-435");
  ASSERT_EQ(scene.texel_bounds.size(), 2u);
  EXPECT_FLOAT_EQ(scene.texel_bounds[0], 0.4f);
  EXPECT_FLOAT_EQ(scene.texel_bounds[1], 0.3f);
  EXPECT_FLOAT_EQ(scene.materials[0].bound_a, 0.4f);
  EXPECT_TRUE(scene.features.spectral_texture);
  ASSERT_EQ(scene.band_sets.size(), 1u);
  EXPECT_EQ(scene.band_sets[0].centres_nm, (std::vector<double>{410, 450, 540}));
  EXPECT_EQ(scene.band_sets[0].min_nm, 400);
  EXPECT_EQ(scene.band_sets[0].max_nm, 600);
  EXPECT_FALSE(scene.band_sets[0].is_emission);
}

/// The specular share of a plastic tells the guide mean:
/// at 430 nm both texels are half-way between two bands.
TEST(SpectralFlatten, GuideMeansWeighLobes) {
  const TemporaryFolder folder;
  write_cube(folder / "a.exr", 2, 1, kBands,
             [](uint32_t x, uint32_t, std::size_t b) { return x == 0 ? 0.1 * b : 0.3; });
  const FlatScene scene = flat(
      "<shape type='sphere'><bsdf type='plastic'><texture type='spectral_bitmap' "
      "name='diffuse_reflectance'><string "
      "name='filename' value='a.exr'/></texture></bsdf></shape><emitter type='constant'/>",
      folder, "425-435");
  const double diffuse = (0.05 + 0.3) / 2;
  EXPECT_NEAR(scene.materials[0].specular_weight, 1 / (1 + diffuse), 1e-6);
}

/// A sky of one colour is as bright as any other of that colour, whatever its number of rows: those of a map of
/// two rows lie at the poles, where a row's own angle has no sine.
TEST(SpectralFlatten, ThePowerOfAMapDoesNotDependOnItsRows) {
  const TemporaryFolder folder;
  const auto probability = [&](const std::string& sky, uint32_t rows) {
    write_cube(folder / "sky.exr", 4, rows, kBands, [](uint32_t, uint32_t, std::size_t) { return 0.5; });
    folder.write("sky.pfm",
                 "Pf\n4 " + std::to_string(rows) + "\n-1\n" + std::string(16 * rows, '?'));  // 0.747
    const FlatScene scene =
        flat("<shape type='sphere'/><emitter type='point'/><emitter type='" + sky + "'/></emitter>", folder,
             "425-435");
    return scene.emitters[scene.environment].select_pdf;
  };
  for (const std::string sky : {"spectral_envmap'><string name='filename' value='sky.exr",
                                "envmap'><string name='filename' value='sky.pfm"}) {
    const float expected = probability(sky, 33);
    EXPECT_GT(expected, 0.01);
    for (const uint32_t rows : {2u, 3u, 8u})
      EXPECT_NEAR(probability(sky, rows), expected, 1e-6) << sky << rows;
  }
}

TEST(SpectralFlatten, DataThatDoNotCoverTheChannelsAreAWarning) {
  const TemporaryFolder folder;
  write_cube(folder / "a.exr", 1, 1, kBands, [](uint32_t, uint32_t, std::size_t) { return 0.5; });
  Messages messages;
  flat(bitmap("a.exr"), folder, "500:700:2", messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "scene.xml:2:23: warning: bsdf: reflectance: data from 400 to 600 nm do not cover 500 to 700 nm; "
            "outside, the "
            "value is 0");
  messages.texts.clear();
  flat(bitmap("a.exr", "<boolean name='extrapolate' value='true'/>"), folder, "500:700:2", messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_NE(messages.texts[0].find("outside, the end values are continued"), std::string::npos);
}

TEST(SpectralFlatten, EndmembersAreConsecutiveRows) {
  const TemporaryFolder folder;
  folder.write("w.ppm", "P3\n2 1\n255\n0 0 51 204 102 51\n");
  const FlatScene scene =
      flat(sphere_with("<spectrum name='reflectance' value='0.5'/>") +
               "<shape type='sphere'><bsdf type='diffuse'><texture type='spectral_bitmap' "
               "name='reflectance'><string "
               "name='weights' value='w.ppm'/><spectrum name='endmember_0' value='0.5'/><spectrum "
               "name='endmember_1' "
               "value='0.25'/><spectrum name='endmember_2' value='400:0.5, 500:1'/></texture></bsdf></shape>",
           folder, "425-475");
  const KbTexture& texture = scene.textures.at(0);
  EXPECT_EQ(texture.values, 3u);
  const double bounds[] = {0.5, 0.25, 0.875};
  for (uint32_t p = 0; p < 3; ++p)
    EXPECT_NEAR(scene.spectra.at(texture.first_row + p).bound, bounds[p], 1e-5) << p;
  EXPECT_NEAR(scene.texel_bounds.at(0), 0.2 * 0.875, 1e-5);
  EXPECT_NEAR(scene.texel_bounds.at(1), 0.8 * 0.5 + 0.4 * 0.25 + 0.2 * 0.875, 1e-5);
}

/// In each of two channels one texel is bright, the first channel's 1e9 times as bright, and the rest is black. Each channel has one vote:
/// half of the directions go to the surroundings of either texel, but for the uniform share.
struct VotingScene {
  TemporaryFolder folder;
  FlatScene scene;
  VotingScene() {
    write_cube(folder / "sky.exr", 16, 9, {{400, 500, ""}, {10000, 11000, ""}},
               [](uint32_t x, uint32_t y, std::size_t b) {
                 if (b == 1) return x == 11 && y == 6 ? 1e-3 : 0;
                 return x == 3 && y == 2 ? 1e6 : 0;
               });
    scene = flat(
        "<shape type='sphere'/><emitter type='spectral_envmap'><string name='filename' "
        "value='sky.exr'/><transform name='to_world'><rotate x='1' y='2' z='3' "
        "angle='50'/></transform></emitter>",
        folder, "440-450, 10500-10501");
  }
};

TEST(SpectralFlatten, EveryChannelHasOneVoteInTheChoiceOfDirections) {
  const VotingScene voting;
  const EnvmapSampling& sampling = voting.scene.envmap;
  const auto around = [&](uint32_t x, uint32_t y) {  // the four cells of a texel
    double probability = 0;
    for (const uint32_t row : {y - 1, y})
      for (const uint32_t column : {x - 1, x}) probability += envmap_probability(sampling, row, column);
    return probability;
  };
  // Of the uniform 1 % they have their part of the sphere, 1.6 %, as have what the mean takes from them on either side.
  EXPECT_NEAR(around(3, 2), 0.495, 0.002);
  EXPECT_NEAR(around(11, 6), 0.495, 0.002);
}

/// Pearson's test of sampled directions by cell of the map: 128 cells, 300 000 samples; fails with
/// probability 1e-5 if the code is right, and finds a cell of probability 1/100 that is 15 % off with
/// probability above 0.99.
TEST(SpectralFlatten, SampledDirectionsFollowTheirDensity) {
  const VotingScene voting;
  const EnvmapSampling& sampling = voting.scene.envmap;
  const KbEmitter& emitter = voting.scene.emitters.at(voting.scene.environment);
  constexpr int kSamples = 300000;
  std::vector<double> observed(sampling.width * sampling.height), expected;
  Uniform uniform(17);
  for (int i = 0; i < kSamples; ++i) {
    const LightSample sample = sample_light(voting.scene, glm::vec3(0), {0, 0}, uniform.pair());
    const glm::vec2 uv = envmap_coordinates(emitter, sample.direction);
    EXPECT_EQ(sample.pdf, envmap_density(sampling, uv));
    const auto row = std::min(static_cast<uint32_t>(uv.y * sampling.height), sampling.height - 1);
    const auto column = static_cast<uint32_t>(uv.x * sampling.width - 0.5f + sampling.width) % sampling.width;
    ++observed[row * sampling.width + column];
  }
  for (uint32_t row = 0; row < sampling.height; ++row) {
    for (uint32_t column = 0; column < sampling.width; ++column) {
      expected.push_back(kSamples * envmap_probability(sampling, row, column));
      ASSERT_GT(expected.back(), 5);
    }
  }
  EXPECT_GT(chi_square(observed, expected).p_value, kTestLevel);
}

/// Lights are chosen by what they emit in each channel: a map with the same power in each
/// as a lamp gets the same part.
TEST(SpectralFlatten, LightsAreChosenByThePowerOfBandsAndMixtures) {
  const TemporaryFolder folder;
  write_cube(folder / "one.exr", 1, 1, kBands,
             [](uint32_t, uint32_t, std::size_t b) { return b == 1 ? 6 : 2; });
  folder.write("w.pgm", "P2\n1 1\n255\n255\n");
  const auto lamp = [](const std::string& radiance) {
    return "<shape type='rectangle'><emitter type='area'>" + radiance + "</emitter></shape>";
  };
  const std::string texture = "<texture type='spectral_bitmap' name='radiance'><string name=";
  const FlatScene scene =
      flat(lamp("<spectrum name='radiance' value='6'/>") +
               lamp(texture + "'filename' value='one.exr'/></texture>") +
               lamp(texture + "'weights' value='w.pgm'/><spectrum name='endmember_0' value='6'/></texture>"),
           folder, "450-450.001");
  for (const KbEmitter& emitter : scene.emitters) EXPECT_NEAR(emitter.select_pdf, 1 / 3.0, 1e-4);
}

/// The brightest value of a channel comes to between 1 and 2 film units.
TEST(SpectralFlatten, ChannelScalesFollowTheBrightestTexel) {
  const TemporaryFolder folder;
  write_cube(folder / "sky.exr", 4, 3, kBands, [](uint32_t x, uint32_t y, std::size_t b) {
    return x == 1 && y == 1 ? (b == 0 ? 1e-6 : 1e9) : 1e-9;
  });
  const FlatScene scene = flat(
      "<shape type='sphere'/><emitter type='spectral_envmap'><string name='filename' "
      "value='sky.exr'/><float name='scale' value='3'/></emitter>",
      folder, "402-404, 530-534");
  EXPECT_EQ(scene.channel_scale[0], std::exp2(std::floor(std::log2(3e-6 * 2))));
  EXPECT_EQ(scene.channel_scale[1], std::exp2(std::floor(std::log2(3e9 * 4))));
}

}  // namespace
}  // namespace kiloband::test::spectral_flatten_test
