// Environment maps of colours and of spectra, and how their directions are drawn.
#include <algorithm>
#include <numbers>

#include "scene/compile/light/emitters.hpp"
#include "scene/compile/light/envmap_sampling.hpp"
#include "scene/compile/record_vectors.hpp"
#include "scene/compile/spectra/band_set.hpp"
#include "scene/compile/spectra/spectral_values.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {

void EmitterCompiler::add_environment_map(KbEmitter& record, const EnvmapEmitter& emitter,
                                          const SpectrumSource& use) {
  record.type = KB_EMITTER_ENVMAP;
  set_transforms(record, emitter.to_world);
  auto bitmap_texture = std::make_shared<BitmapTexture>();
  bitmap_texture->image = emitter.image;
  bitmap_texture->file = emitter.file;
  bitmap_texture->position = use.position;
  const uint32_t index = textures_.bitmap(bitmap_texture, BitmapUse::kEnvironment);
  record.ref = KB_REF_BITMAP | index;
  KbTexture& texture = out_.textures[index];
  texture.flags = KB_TEXTURE_ENVMAP;
  out_.features.envmap_light = true;

  // Selection and sampling weights: each texel's mean radiance is its colour's, up to the common D65 factor.
  const std::size_t count = std::size_t{texture.width} * texture.height;
  const std::vector<double> solid_angles = row_solid_angles(texture.height);
  std::vector<float> weights(count);
  double mean = 0;
  for (std::size_t i = 0; i < count; ++i) {
    KbFloat4& texel = out_.texels[texture.first_texel + i];
    texel.w *= static_cast<float>(emitter.scale);
    textures_.peaks().rgb = std::max(textures_.peaks().rgb, double{texel.w});
    const std::size_t channels = emitter.image->channels;
    double value = 0;
    for (std::size_t c = 0; c < channels; ++c) value += emitter.image->pixels[channels * i + c];
    weights[i] = static_cast<float>(value * emitter.scale / static_cast<double>(channels));
    mean += weights[i] * solid_angles[i / texture.width];
  }
  mean /= static_cast<double>(count);
  out_.envmap = build_envmap_sampling(texture.width, texture.height, weights);
  powers_.push_back({illuminant_d65().scaled(mean),
                     4 * std::numbers::pi * std::numbers::pi * out_.scene_radius * out_.scene_radius});
}

void EmitterCompiler::add_spectral_environment(KbEmitter& record, const SpectralEnvmapEmitter& emitter,
                                               const SpectrumSource& use) {
  record.type = KB_EMITTER_ENVMAP;
  set_transforms(record, emitter.to_world);
  SpectralBitmapTexture texture;
  texture.image = emitter.image;
  texture.position = use.position;
  const uint32_t index = textures_.add_spectral_texture(texture, use, emitter.scale);
  out_.textures[index].flags |= KB_TEXTURE_ENVMAP;
  record.ref = KB_REF_BITMAP | index;
  out_.features.envmap_light = true;

  // Directions are sampled by sum_g L_g(texel) / mean L_g over the guide bands g: each has one vote. As a
  // weighted sum of a texel's values v: the weight of v_i is sum_g A_gi / (A v_mean)_g, A_gi its part in the
  // mean of guide band g.
  const SpectralImage& image = *emitter.image;
  const BandSet& set = out_.band_sets[out_.textures[index].first_row];
  const ValueStatistics statistics(image, row_solid_angles(image.height));
  std::vector<double> votes(set.centres_nm.size(), 0.0), part(votes.size());
  for (const Channel& band : out_.guide) {
    std::ranges::fill(part, 0.0);
    add_mean_weights(set, band, part);
    double mean = 0;
    for (std::size_t v = 0; v < part.size(); ++v) mean += part[v] * statistics.mean[v];
    for (std::size_t v = 0; v < part.size() && mean > 0; ++v) votes[v] += part[v] / mean;
  }
  const std::size_t count = std::size_t{image.width} * image.height;
  std::vector<float> weights(count);
  for (std::size_t i = 0; i < count; ++i) weights[i] = static_cast<float>(dot(texel(image, i), votes));
  out_.envmap = build_envmap_sampling(image.width, image.height, weights);
  powers_.push_back({band_spectrum(set, statistics.mean),
                     4 * std::numbers::pi * std::numbers::pi * out_.scene_radius * out_.scene_radius});
}

}  // namespace kiloband
