#include "src_gpu/scene/centred_texels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shared/spectra_layout.h"

namespace kiloband::test {
namespace {

KbFloat4 random_texel(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  // As saturated colours have them: terms of a thousand whose sum is of order 1.
  const float c0 = 4e-3f * unit(random), x0 = 600 + 200 * unit(random);
  return {c0, -2 * c0 * x0, c0 * x0 * x0 + 3 * unit(random), 0.5f};
}

TEST(CentredTexels, HaveTheSameParabolas) {
  std::mt19937 random(7);
  FlatScene scene;
  for (int i = 0; i < 100; ++i) scene.texels.push_back(random_texel(random));
  scene.textures.resize(1);
  scene.textures[0].width = scene.textures[0].height = 10;
  const std::vector<KbFloat4> texels = opencl::centred_texels(scene);
  for (std::size_t i = 0; i < 100; ++i) {
    const KbFloat4 &from = scene.texels[i], &to = texels[i];
    EXPECT_EQ(to.w, from.w);
    for (double x = 360; x <= 830; x += 10) {
      const double wanted = (double{from.x} * x + from.y) * x + from.z;
      const float y = static_cast<float>(x) - KB_TEXTURE_CENTRE_NM;
      const float got = std::fma(std::fma(to.x, y, to.y), y, to.z);
      // A rounding of each of b and c, of the slope times y and of the sum.
      const double terms = std::abs(to.x) * y * y + std::abs(double{to.y} * y) + std::abs(to.z);
      EXPECT_NEAR(got, wanted, 1.8e-7 * terms) << "texel " << i << " at " << x << " nm";
    }
  }
}

TEST(CentredTexels, NumbersAndNormalsStay) {
  FlatScene scene;
  scene.texels = {{0, 0, 1e10f, 0.3f}, {0, 0, -2, 1}, {0.3f, 0.4f, 0.5f, 1}, {0.3f, 0.4f, 0.5f, 1}};
  scene.textures.resize(2);
  for (KbTexture& texture : scene.textures) texture.width = 2, texture.height = 1;
  scene.textures[1].first_texel = 2;
  scene.textures[1].flags = KB_TEXTURE_NORMALS;
  const std::vector<KbFloat4> texels = opencl::centred_texels(scene);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(texels[i].x, scene.texels[i].x) << i;
    EXPECT_EQ(texels[i].y, scene.texels[i].y) << i;
    EXPECT_EQ(texels[i].z, scene.texels[i].z) << i;
    EXPECT_EQ(texels[i].w, scene.texels[i].w) << i;
  }
  scene.textures[1].flags = 0;
  EXPECT_NE(opencl::centred_texels(scene)[2].y, scene.texels[2].y);
}

}  // namespace
}  // namespace kiloband::test
