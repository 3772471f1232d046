// Textures of random spectra and mixtures for the evaluator's tests.
#include <algorithm>

#include "random_scene.hpp"

namespace kiloband::test {
namespace {

void add_texture(FlatScene& scene, uint32_t flags, uint32_t values, uint32_t first_row, double low,
                 double high, std::mt19937& random) {
  KbTexture texture{};
  texture.width = 1 + random() % 4;
  texture.height = 1 + random() % 4;
  texture.wrap = random() % 3;
  texture.flags = flags;
  texture.illuminant_row = KB_NONE;
  texture.values = values;
  texture.first_row = first_row;
  uint32_t units = 0;
  for (std::size_t t = 0; t < scene.spectral_texels.size(); ++t)
    if (scene.spectral_texels[t])
      units += static_cast<uint32_t>((scene.spectral_texels[t]->size() + KB_VALUE_UNIT - 1) / KB_VALUE_UNIT);
  texture.first_value = units;
  std::vector<float> texels;
  for (uint32_t i = 0; i < texture.width * texture.height * values; ++i)
    texels.push_back(static_cast<float>(uniform(random, low, high)));
  scene.spectral_texels.resize(scene.textures.size() + 1);
  scene.spectral_texels.back() = std::make_shared<const std::vector<float>>(std::move(texels));
  scene.textures.push_back(texture);
}

/// Steps of any width; data may end inside the channels.
BandSet random_bands(const Channel& range, uint32_t count, bool emission, std::mt19937& random) {
  BandSet set;
  double nm = range.min_nm + uniform(random, -0.1, 0.1) * range.width_nm();
  for (uint32_t i = 0; i < count; ++i) {
    set.centres_nm.push_back(nm);
    nm += uniform(random, 0.2, 1.8) * range.width_nm() / count;
  }
  set.min_nm = set.centres_nm.front() - 0.03 * range.width_nm();
  set.max_nm = set.centres_nm.back() + 0.03 * range.width_nm();
  set.extrapolate = random() % 2 == 0;
  set.is_emission = emission;
  set.scale = emission ? 3.5 : 1;
  return set;
}

}  // namespace

void add_spectral_textures(FlatScene& scene, const Channel& range, uint32_t first_emission,
                           std::mt19937& random) {
  for (const bool emission : {false, true}) {
    const double high = emission ? 500 : 1;
    for (const uint32_t count : {12u, emission ? 1u : 40u}) {
      scene.band_sets.push_back(random_bands(range, count, emission, random));
      add_texture(scene, KB_TEXTURE_BANDS | (emission ? KB_TEXTURE_ENVMAP : 0), count,
                  static_cast<uint32_t>(scene.band_sets.size() - 1), 0.001 * high, high, random);
    }
    add_texture(scene, KB_TEXTURE_WEIGHTS, 3, emission ? first_emission : 0, 0.01, 0.4, random);
  }
}

}  // namespace kiloband::test
