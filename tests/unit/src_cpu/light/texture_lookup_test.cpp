// Texture addressing against a plain reference in double precision.
#include "src_cpu/geometry/texture/texture_lookup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test_scene.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::texture_lookup_test {

using namespace cpu;
namespace {

/// Index i of an axis of n texels, wrapped by the textbook rules.
int wrapped(long long i, int n, uint32_t wrap) {
  if (wrap == KB_WRAP_CLAMP) return static_cast<int>(std::min<long long>(std::max<long long>(i, 0), n - 1));
  const long long period = wrap == KB_WRAP_MIRROR ? 2 * n : n;
  const int j = static_cast<int>(((i % period) + period) % period);
  return j < n ? j : 2 * n - 1 - j;
}

FlatScene texture_scene(int width, int height, uint32_t wrap, uint32_t flags) {
  FlatScene scene;
  KbTexture texture{};
  texture.width = width;
  texture.height = height;
  texture.wrap = wrap;
  texture.flags = flags;
  texture.to_uv[0] = texture.to_uv[4] = 1;
  // The texture does not begin at texel 0.
  texture.first_bound = 2;
  scene.texel_bounds.assign(2, -1000);
  for (int i = 0; i < width * height; ++i) scene.texel_bounds.push_back(static_cast<float>((i * 7) % 19));
  scene.textures = {texture};
  return scene;
}

double reference(const FlatScene& scene, double u, double v) {
  const KbTexture& t = scene.textures[0];
  const int width = t.width, height = t.height;
  const auto at = [&](double x, double y) -> double {
    const int i = wrapped(std::llround(x), width, t.wrap), j = wrapped(std::llround(y), height, t.wrap);
    return scene.texel_bounds[t.first_bound + j * width + i];
  };
  if (t.flags & KB_TEXTURE_NEAREST) return at(std::floor(u * width), std::floor(v * height));
  const double x = u * width - 0.5, y = v * height - 0.5, x0 = std::floor(x), y0 = std::floor(y);
  const double fx = x - x0, fy = y - y0;
  return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
         fy * ((1 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
}

TEST(Bitmap, AllWrapModesBilinearAndNearest) {
  const int sizes[][2] = {{5, 3}, {1, 4}, {2, 1}, {1, 1}, {8, 8}};
  for (const uint32_t wrap : {KB_WRAP_REPEAT, KB_WRAP_MIRROR, KB_WRAP_CLAMP}) {
    for (const uint32_t flags : {0u, KB_TEXTURE_NEAREST}) {
      for (const auto& size : sizes) {
        const FlatScene scene = texture_scene(size[0], size[1], wrap, flags);
        Uniform uniform(1);
        for (int i = 0; i < 3000; ++i) {
          // Multiples of 1/16 hit borders and centres exactly; the others lie anywhere in [-4, 4).
          glm::vec2 uv = uniform.pair() * 8.0f - 4.0f;
          if (i % 2) uv = glm::floor(uv * 16.0f) / 16.0f;
          const KbTextureSample sample = sample_bitmap(scene.textures[0], 0, uv);
          ASSERT_LT(sample.xy & 0xffffu, scene.textures[0].width);
          ASSERT_LT(sample.xy >> 16, scene.textures[0].height);
          ASSERT_TRUE(sample.fx >= 0 && sample.fx <= 1 && sample.fy >= 0 && sample.fy <= 1);
          ASSERT_NEAR(bitmap_value(scene, sample), reference(scene, uv.x, uv.y), 2e-5)
              << "wrap " << wrap << " flags " << flags << " uv " << uv.x << " " << uv.y;
        }
      }
    }
  }
}

TEST(Bitmap, StoredBlocksReadWithoutWeights) {
  // Readers take x1 = wrap(x0 + 1): in the mirrored half the block is stored in ascending order.
  const FlatScene scene = texture_scene(5, 1, KB_WRAP_MIRROR, 0);
  const KbTextureSample sample =
      sample_bitmap(scene.textures[0], 0, {1.34f, 0.5f});  // x = 6.2: between 3 and 2
  EXPECT_EQ(sample.xy & 0xffffu, 2u);
  EXPECT_NEAR(sample.fx, 0.8, 1e-5);
}

TEST(Bitmap, ToUvAndAbsurdCoordinates) {
  FlatScene scene = texture_scene(5, 3, KB_WRAP_REPEAT, 0);
  const float to_uv[6] = {2, 0.5f, 0.25f, -1, 3, 0.75f};
  std::copy(std::begin(to_uv), std::end(to_uv), scene.textures[0].to_uv);
  const float value = bitmap_value(scene, sample_bitmap(scene.textures[0], 0, {0.3f, 0.6f}));
  EXPECT_NEAR(value, reference(scene, 0.6 + 0.3 + 0.25, -0.3 + 1.8 + 0.75), 2e-5);
  const float infinity = std::numeric_limits<float>::infinity();
  for (const uint32_t wrap : {KB_WRAP_REPEAT, KB_WRAP_MIRROR, KB_WRAP_CLAMP}) {
    scene.textures[0].wrap = wrap;
    for (const float x : {infinity, -infinity, std::nanf(""), 1e30f, -1e30f, 1e8f}) {
      const KbTextureSample sample = sample_bitmap(scene.textures[0], 0, {x, -x});
      ASSERT_LT(sample.xy & 0xffffu, 5u);
      ASSERT_LT(sample.xy >> 16, 3u);
      ASSERT_TRUE(std::isfinite(bitmap_value(scene, sample)));
    }
  }
}

TEST(Checkerboard, ChoosesTheRow) {
  FlatScene scene;
  scene.checkerboards = {{11, 22, {2, 0, 0, 0, 2, 0}}};
  const auto row = [&](float u, float v) { return resolve_spectrum(scene, KB_REF_CHECKERBOARD, {u, v}).row; };
  EXPECT_EQ(row(0.1f, 0.1f), 11);
  EXPECT_EQ(row(0.3f, 0.1f), 22);
  EXPECT_EQ(row(0.3f, 0.3f), 11);
  EXPECT_EQ(row(0.6f, 0.1f), 11);   // second period
  EXPECT_EQ(row(-0.1f, 0.1f), 22);  // to the left
  EXPECT_EQ(row(0.25f, 0.1f), 11);  // a border belongs to the first half
}

TEST(ResolveSpectrum, RowsAndBitmaps) {
  FlatScene scene = texture_scene(5, 3, KB_WRAP_REPEAT, 0);
  EXPECT_EQ(resolve_spectrum(scene, KB_REF_SPECTRUM | 65535u, {0, 0}).row, 65535);
  EXPECT_FALSE(resolve_spectrum(scene, KB_REF_SPECTRUM | 7u, {0, 0}).textured);
  const ResolvedSpectrum bitmap = resolve_spectrum(scene, KB_REF_BITMAP | 0u, {0.5f, 0.5f});
  EXPECT_TRUE(bitmap.textured);
  EXPECT_EQ(bitmap.texture.xy, 2u | 1u << 16);
}

TEST(EnvironmentMap, AxesAndBorders) {
  // Texel (i, j) of 8 x 5 holds 100 j + i; u = atan2(x, -z) / 2 pi: -z at 0, +x at 1/4, +z at 1/2, -x at 3/4.
  KbEmitter emitter = make_emitter(KB_EMITTER_ENVMAP);
  emitter.ref = KB_REF_BITMAP;
  FlatScene scene = scene_with(emitter);
  KbTexture texture{};
  texture.width = 8;
  texture.height = 5;
  texture.flags = KB_TEXTURE_ENVMAP;
  scene.textures = {texture};
  for (int i = 0; i < 40; ++i) scene.texel_bounds.push_back(static_cast<float>(100 * (i / 8) + i % 8));
  const auto value = [&](glm::vec3 d) { return bitmap_value(scene, environment_radiance(scene, d).texture); };
  EXPECT_NEAR(value({1, 0, 0}), 200 + 1.5, 1e-4);  // x = 8/4 - 0.5
  EXPECT_NEAR(value({0, 0, 1}), 200 + 3.5, 1e-4);
  EXPECT_NEAR(value({-1, 0, 0}), 200 + 5.5, 1e-4);
  EXPECT_NEAR(value({0, 0, -1}), 200 + 3.5, 1e-4);  // over the seam: the mean of columns 7 and 0
  const float poles[] = {value({0, 1, 0}), value({0, -1, 0})};
  EXPECT_LT(poles[0], 8);    // row 0
  EXPECT_GE(poles[1], 400);  // row 4
  EXPECT_EQ(sample_envmap_texture(texture, 0, {0.5f, 1.0f}).fy, 0);
  EXPECT_EQ(sample_envmap_texture(texture, 0, {0.0f, 0.0f}).xy, 7u);
}

}  // namespace
}  // namespace kiloband::test::texture_lookup_test
