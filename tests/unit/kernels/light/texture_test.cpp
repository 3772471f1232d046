// Texture addressing on the device against src_cpu/geometry/texture/texture_lookup.cpp, which computes in double.
#include <limits>

#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "support.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::texture_test {

using namespace cpu;
namespace {

const char* const kSource = R"(
#include "geometry/texture.clh"
__kernel void resolve(ARGS) {
  ITEM
  const ResolvedSpectrum r = resolve_spectrum(&scene, in->u[0], place_at(VEC2(0)));
  out->u[0] = r.row; out->u[1] = r.textured; out->u[2] = r.texture.xy; out->u[3] = r.texture.texture;
  out->f[0] = r.texture.fx; out->f[1] = r.texture.fy;
  out->f[2] = r.textured ? bitmap_value(&scene, &r.texture) : 0.0f;
  out->f[3] = spectrum_bound(&scene, &r);
}
__kernel void envmap(ARGS) {
  ITEM
  const KbTextureSample s = envmap_texture_sample(&scene.textures[in->u[0]], in->u[0], VEC2(0));
  out->u[2] = s.xy; out->u[3] = s.texture;
  out->f[0] = s.fx; out->f[1] = s.fy;
}
)";

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + kSource);
  return instance;
}

/// Textures of several sizes in every wrap and filter mode under several maps,
/// and checkerboards under the same maps.
FlatScene texture_scene() {
  const float maps[][6] = {{1, 0, 0, 0, 1, 0},
                           {3.7f, -1.2f, 0.3f, 0.9f, 2.1f, -17.4f},
                           {1000, 0, 0.125f, 0, -500, 3},
                           {0, 0.1f, 1e4f, -0.1f, 0, -1e4f}};
  const uint32_t sizes[][2] = {{5, 3}, {1, 4}, {2, 1}, {1, 1}, {256, 130}, {65536, 2}};
  FlatScene scene;
  Random random(1);
  for (const auto& size : sizes) {
    const auto first = static_cast<uint32_t>(scene.texels.size());
    for (uint32_t i = 0; i < size[0] * size[1]; ++i) {
      scene.texels.push_back({0, 0, 1e10f, random.unit()});
      scene.texel_bounds.push_back(random.unit());
    }
    for (const auto& map : maps) {
      for (const uint32_t wrap : {KB_WRAP_REPEAT, KB_WRAP_MIRROR, KB_WRAP_CLAMP}) {
        for (const uint32_t flags : {0u, KB_TEXTURE_NEAREST}) {
          KbTexture texture{size[0], size[1], first, wrap, flags, KB_NONE, {}, first};
          std::copy_n(map, 6, texture.to_uv);
          scene.textures.push_back(texture);
        }
      }
    }
  }
  for (const auto& map : maps) {
    KbCheckerboard board{1, 2, {}};
    std::copy_n(map, 6, board.to_uv);
    scene.checkerboards.push_back(board);
  }
  scene.spectra.resize(3);
  for (std::size_t i = 0; i < 3; ++i) scene.spectra[i].bound = 0.25f * static_cast<float>(i + 1);
  return scene;
}

float coordinate(Random& random) {
  switch (random.index(4)) {
    case 0:
      return static_cast<float>(static_cast<int>(random.index(65)) - 32) / 16;  // texel borders and centres
    case 1:
      return random.between(-50, 50);
    default:
      return random.unit();
  }
}

std::vector<ItemIn> random_references(const FlatScene& scene, std::size_t count) {
  Random random(2);
  std::vector<ItemIn> in(count);
  for (ItemIn& item : in) {
    item.f[0] = coordinate(random);
    item.f[1] = coordinate(random);
    const uint32_t kind = random.index(8);
    item.u[0] = kind == 0 ? KB_REF_SPECTRUM | random.index(3)
                : kind == 1
                    ? KB_REF_CHECKERBOARD | random.index(static_cast<uint32_t>(scene.checkerboards.size()))
                    : KB_REF_BITMAP | random.index(static_cast<uint32_t>(scene.textures.size()));
  }
  return in;
}

/// The same texels, and weights within 1e-5: the pairs of floats hold coordinates of up to 65536 * 1e4 texels
/// to 2^-44 of their size (4e-5 there, 1e-6 below 2e7 texels).
TEST(GpuTexture, EveryWrapAndFilterModeAsOnTheCpu) {
  const FlatScene scene = texture_scene();
  const std::vector<ItemIn> in = random_references(scene, 400000);
  const std::vector<ItemOut> out = run_items(probe(), "resolve", scene, in);
  std::size_t other_texel = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const ResolvedSpectrum expected = resolve_spectrum(scene, in[i].u[0], get2(in[i], 0));
    ASSERT_EQ(out[i].u[0], expected.row) << i;
    ASSERT_EQ(out[i].u[1], expected.textured ? 1u : 0u) << i;
    if (!expected.textured) {
      ASSERT_EQ(out[i].f[3], spectrum_bound(scene, expected));
      continue;
    }
    ASSERT_EQ(out[i].u[3], expected.texture.texture);
    if (out[i].u[2] != expected.texture.xy) {
      ++other_texel;
      continue;
    }
    ASSERT_NEAR(out[i].f[0], expected.texture.fx, 1e-4) << i;
    ASSERT_NEAR(out[i].f[1], expected.texture.fy, 1e-4) << i;
    ASSERT_EQ(out[i].f[3], spectrum_bound(scene, expected));
    ASSERT_NEAR(out[i].f[2], bitmap_value(scene, expected.texture), 2e-4);
  }
  // Where a coordinate of 6e8 texels is within rounding of a texel's border.
  EXPECT_LE(other_texel, in.size() / 100000);
}

/// Without large offsets the weights are those of the CPU to the last bits.
TEST(GpuTexture, OrdinaryCoordinatesAgreeToTheLastBits) {
  FlatScene scene = texture_scene();
  for (KbTexture& texture : scene.textures) texture.to_uv[2] = 0.3f, texture.to_uv[5] = -0.7f;
  const std::vector<ItemIn> in = random_references(scene, 200000);
  const std::vector<ItemOut> out = run_items(probe(), "resolve", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const ResolvedSpectrum expected = resolve_spectrum(scene, in[i].u[0], get2(in[i], 0));
    ASSERT_EQ(out[i].u[0], expected.row);
    if (!expected.textured) continue;
    ASSERT_EQ(out[i].u[2], expected.texture.xy) << i;
    ASSERT_NEAR(out[i].f[0], expected.texture.fx, 1e-6) << i;
    ASSERT_NEAR(out[i].f[1], expected.texture.fy, 1e-6) << i;
  }
}

/// Infinite, NaN and huge coordinates stay inside the image.
TEST(GpuTexture, UnusableCoordinatesStayInside) {
  const FlatScene scene = texture_scene();
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<ItemIn> in;
  for (uint32_t texture = 0; texture < scene.textures.size(); ++texture) {
    for (const float u : {inf, -inf, nan, 3e38f, -3e38f, 1e20f, 1e11f}) {
      for (const float v : {inf, -inf, nan, 3e38f, 0.3f}) in.push_back({{u, v}, {KB_REF_BITMAP | texture}});
    }
  }
  const std::vector<ItemOut> out = run_items(probe(), "resolve", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const KbTexture& texture = scene.textures[in[i].u[0] & KB_REF_INDEX_MASK];
    ASSERT_LT(out[i].u[2] & 0xffffu, texture.width) << i;
    ASSERT_LT(out[i].u[2] >> 16, texture.height) << i;
    ASSERT_TRUE(out[i].f[0] >= 0 && out[i].f[0] <= 1 && out[i].f[1] >= 0 && out[i].f[1] <= 1) << i;
    if (texture.wrap == KB_WRAP_CLAMP && texture.to_uv[1] == 0 && texture.to_uv[0] > 0 &&
        std::isinf(in[i].f[0]) && std::isfinite(in[i].f[1])) {
      ASSERT_EQ(out[i].u[2] & 0xffffu, in[i].f[0] > 0 ? texture.width - 1 : 0) << i;
    }
  }
}

TEST(GpuTexture, EnvironmentMapsAddressTheSameTexels) {
  const FlatScene scene = texture_scene();
  Random random(3);
  std::vector<ItemIn> in(100000);
  for (ItemIn& item : in) {
    const bool corner = random.index(10) == 0;
    item.f[0] = corner ? static_cast<float>(random.index(8)) / 8 : random.unit();
    item.f[1] = corner ? static_cast<float>(random.index(9)) / 8 : random.unit();
    item.u[0] = random.index(static_cast<uint32_t>(scene.textures.size()));
  }
  const std::vector<ItemOut> out = run_items(probe(), "envmap", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const KbTextureSample expected =
        sample_envmap_texture(scene.textures[in[i].u[0]], in[i].u[0], get2(in[i], 0));
    ASSERT_EQ(out[i].u[2], expected.xy) << in[i].f[0] << " " << in[i].f[1];
    ASSERT_EQ(out[i].u[3], expected.texture);
    ASSERT_EQ(out[i].f[0], expected.fx);
    ASSERT_EQ(out[i].f[1], expected.fy);
  }
}

}  // namespace
}  // namespace kiloband::test::texture_test
