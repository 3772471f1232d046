// Rows of colours against lookups that are evaluated.
#include <algorithm>
#include <cmath>
#include <random>

#include "random_scene.hpp"
#include "spectral/colour/rgb.hpp"
#include "src_cpu/evaluate/texture/colour_lookups.hpp"

namespace kiloband::test::test_colour_lookups {
namespace {

class ColourLookup : public EachIsa {};
INSTANTIATE_TEST_SUITE_P(, ColourLookup, testing::ValuesIn(available_isas()), isa_name);

struct Size {
  uint32_t width, height;
};

/// Pictures whose colours have rows, or not: 48, 2560, 900 and 500 of one texel each, six of 60000 texels and of more than are looked at, and 70.
constexpr Size kSizes[] = {{8, 6}, {64, 40}, {30, 30}, {25, 20}, {300, 200}, {300, 219}, {10, 7}};
constexpr bool kHasRows[] = {true, false, true, false, true, false, true};
constexpr bool kFewColours[] = {false, false, false, false, true, true, false};

FlatScene pictures(std::size_t channels) {
  static const SigmoidTable sigmoids;
  FlatScene scene;
  const double step = 300.0 / static_cast<double>(channels);
  for (std::size_t k = 0; k < channels; ++k) {
    const double from = 400 + step * static_cast<double>(k);
    scene.channels.push_back({from, from + step, {}});
  }
  scene.channel_scale.assign(channels, 1.0);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::size_t t = 0; t < std::size(kSizes); ++t) {
    const Size size = kSizes[t];
    std::array<std::array<float, 3>, 6> few;
    for (auto& colour : few) colour = sigmoids({unit(random), unit(random), unit(random)});
    KbTexture texture{};
    texture.width = size.width;
    texture.height = size.height;
    texture.first_texel = static_cast<uint32_t>(scene.texels.size());
    texture.wrap = KB_WRAP_REPEAT;
    texture.illuminant_row = KB_NONE;
    scene.textures.push_back(texture);
    for (uint32_t i = 0; i < size.width * size.height; ++i) {
      const std::array<float, 3> c =
          kFewColours[t] ? few[random() % few.size()] : sigmoids({unit(random), unit(random), unit(random)});
      scene.texels.push_back(i % 5 == 0 ? KbFloat4{0, 0, 1e10f, unit(random)}
                                        : KbFloat4{c[0], c[1], c[2], unit(random)});
    }
  }
  return scene;
}

/// Lookups of one scene at an offset.
struct Lookups {
  Lookups(const FlatScene& of, Isa isa, double mu, bool fast = false)
      : scene(of),
        kernels(evaluator_kernels(isa)),
        spectra(scene, kernels),
        colours(scene, kernels),
        out(aligned_zeros<float>(spectra.padded_channels())) {
    spectra.begin(mu, fast);
  }

  TexelCorners corners(const KbTextureSample& sample) const {
    return {scene.textures[sample.texture], sample};
  }
  const float* row(const KbTextureSample& sample, const float* factor) {
    return colours.row(sample.texture, corners(sample), factor, spectra, {0, spectra.channels(), false},
                       out.get());
  }
  std::vector<float> values(const KbTextureSample& sample, const float* factor = nullptr) {
    const float* values = row(sample, factor);
    return {values, values + spectra.channels()};
  }
  std::vector<float> evaluated(const KbTextureSample& sample, const float* factor = nullptr) {
    colours.evaluate(sample.texture, corners(sample), factor, spectra, {0, spectra.channels(), false},
                     out.get());
    return {out.get(), out.get() + spectra.channels()};
  }

  const FlatScene& scene;
  const EvaluatorKernels& kernels;
  DenseSpectra spectra;
  ColourLookups colours;
  hwy::AlignedFreeUniquePtr<float[]> out;
};

KbTextureSample random_sample(uint32_t texture, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  const uint32_t x = static_cast<uint32_t>(random()) % kSizes[texture].width,
                 y = static_cast<uint32_t>(random()) % kSizes[texture].height;
  return {texture, x | y << 16, unit(random), unit(random)};
}

TEST_P(ColourLookup, FewColoursHaveRows) {
  const FlatScene scene = pictures(16);
  const Lookups lookups(scene, GetParam(), 0.5);
  for (uint32_t t = 0; t < std::size(kSizes); ++t) EXPECT_EQ(lookups.colours.has_rows(t), kHasRows[t]) << t;
}

/// What is no sum is the row itself, whatever colours come four times.
TEST_P(ColourLookup, OneColourIsItsRow) {
  FlatScene scene = pictures(16);
  for (std::size_t i = 0; i < 48; ++i) scene.texels[i] = KbFloat4{1e-5f, 2e-3f, -1, 1};
  Lookups lookups(scene, GetParam(), 0.5);
  const float* const row = lookups.row({0, 2 | 3 << 16, 0.3f, 0.9f}, nullptr);
  EXPECT_NE(row, lookups.out.get());
  EXPECT_EQ(row, lookups.row({0, 5 | 1 << 16, 0.123f, 0.77f}, nullptr));
  scene.texels[48 - 1].w = 0.5f;
  EXPECT_EQ(lookups.row({0, 7 | 5 << 16, 0.3f, 0.9f}, nullptr), lookups.out.get());
}

/// Of 512 channels colours are interpolated in cells, by texels or by lookups.
TEST_P(ColourLookup, RowsAddUpToTheLookup) {
  for (const std::size_t channels : {7u, 512u}) {
    const FlatScene scene = pictures(channels);
    Lookups lookups(scene, GetParam(), 0.3);
    std::vector<float> factor(lookups.spectra.padded_channels());
    for (std::size_t k = 0; k < factor.size(); ++k) factor[k] = 0.5f + static_cast<float>(k % 11);
    std::mt19937 random(4);
    double largest = 0;
    for (int i = 0; i < 200; ++i) {
      const KbTextureSample sample = random_sample(i % 4 == 1 ? 6 : i % 4 == 3 ? 4 : 0, random);
      const float* const scaled = i % 3 == 0 ? factor.data() : nullptr;
      const std::vector<float> values = lookups.values(sample, scaled),
                               expected = lookups.evaluated(sample, scaled);
      for (std::size_t k = 0; k < channels; ++k)
        largest = std::max(largest, std::abs(double{values[k]} / expected[k] - 1));
    }
    EXPECT_LT(largest, 2.4e-6) << channels;  // twice what a lookup's error may be, see test_colour_cells.cpp
    EXPECT_GT(largest, 0) << channels;
  }
}

TEST_P(ColourLookup, OffsetsHaveRowsOfTheirOwn) {
  const FlatScene scene = pictures(100);
  Lookups lookups(scene, GetParam(), 0.2), fresh(scene, GetParam(), 0.7);
  std::mt19937 random(5);
  for (int i = 0; i < 20; ++i) {
    const KbTextureSample sample = random_sample(0, random);
    lookups.spectra.begin(0.2, false);
    const std::vector<float> before = lookups.values(sample);
    lookups.spectra.begin(0.7, false);
    const std::vector<float> values = lookups.values(sample);
    EXPECT_NE(values, before);
    EXPECT_EQ(values, fresh.values(sample));
  }
}

TEST_P(ColourLookup, OnePathsLookupsAreEvaluated) {
  const FlatScene scene = pictures(20);
  Lookups lookups(scene, GetParam(), 0.4, true);
  std::mt19937 random(6);
  for (uint32_t t = 0; t < std::size(kSizes); ++t) {
    const KbTextureSample sample = random_sample(t, random);
    EXPECT_EQ(lookups.row(sample, nullptr), lookups.out.get());
    EXPECT_EQ(lookups.values(sample), lookups.evaluated(sample));
  }
}

}  // namespace
}  // namespace kiloband::test::test_colour_lookups
