#include "src_cpu/evaluate/texture/spectral_textures.hpp"

#include <algorithm>
#include <stdexcept>

#include "scene/compile/spectra/band_set.hpp"
#include "src_cpu/evaluate/texture/texel_corners.hpp"

namespace kiloband::cpu {

SpectralTextures::SpectralTextures(const FlatScene& scene, const EvaluatorKernels& kernels)
    : scene_(scene), kernels_(kernels) {
  for (const BandSet& set : scene.band_sets) rows_.push_back(make_rows(set));
}

SpectralTextures::BandRows SpectralTextures::make_rows(const BandSet& set) const {
  BandRows rows;
  for (const Channel& channel : scene_.channels) {
    rows.lowest.push_back(band_position(set, channel.min_nm).index);
    rows.highest.push_back(band_position(set, channel.max_nm).index);
  }
  for (std::size_t i = 1; i < set.centres_nm.size(); ++i)
    rows.inverse_gap.push_back(1 / (set.centres_nm[i] - set.centres_nm[i - 1]));
  // Whole vectors, which end where they would if all bands were blended, so that their bits are the same.
  constexpr std::size_t kWhole = 16;
  const std::size_t bands = set.centres_nm.size();
  rows.begin = std::ranges::min(rows.lowest) / kWhole * kWhole;
  rows.end = std::min(bands, (std::ranges::max(rows.highest) + 2 + kWhole - 1) / kWhole * kWhole);
  const std::size_t padded = pad_channels(scene_.channels.size());
  rows.index = aligned_zeros<int32_t>(padded);
  std::fill_n(rows.index.get(), padded, static_cast<int32_t>(rows.begin));
  rows.first = aligned_zeros<float>(padded);
  rows.second = aligned_zeros<float>(padded);
  return rows;
}

/// The same positions as band_position(), found within the few bands that a channel can meet.
const SpectralTextures::BandRows& SpectralTextures::band_rows(uint32_t number, const DenseSpectra& spectra) {
  BandRows& rows = rows_.at(number);
  if (rows.generation == spectra.generation()) return rows;
  rows.generation = spectra.generation();
  const BandSet& set = scene_.band_sets[number];
  const double* lambda_nm = spectra.lambda_nm();
  for (std::size_t k = 0; k < spectra.channels(); ++k) {
    const double nm = lambda_nm[k];
    const double unit = set.is_emission ? set.scale * spectra.emission_factor(k) : set.scale;
    const bool inside = set.extrapolate || (nm >= set.min_nm && nm <= set.max_nm);
    const auto begin = set.centres_nm.begin() + rows.lowest[k] + 1;
    const auto end = set.centres_nm.begin() + rows.highest[k] + 1;
    const auto i = static_cast<std::size_t>(std::upper_bound(begin, end, nm) - set.centres_nm.begin()) - 1;
    double fraction = 0;
    if (!rows.inverse_gap.empty())
      fraction = std::clamp((nm - set.centres_nm[i]) * rows.inverse_gap[i], 0.0, 1.0);
    rows.index[k] = static_cast<int32_t>(i);
    rows.first[k] = inside ? static_cast<float>(unit * (1 - fraction)) : 0;
    rows.second[k] = inside ? static_cast<float>(unit * fraction) : 0;
  }
  return rows;
}

void SpectralTextures::blend(const KbTexture& texture, uint32_t index, const KbTextureSample& sample) {
  const bool of_bands = texture.flags & KB_TEXTURE_BANDS;
  const std::size_t begin = of_bands ? rows_.at(texture.first_row).begin : 0;
  const std::size_t end = of_bands ? rows_.at(texture.first_row).end : texture.values;
  if (index >= scene_.spectral_texels.size() || !scene_.spectral_texels[index])
    throw std::logic_error("saved path: texture without spectral texels");
  const float* values = scene_.spectral_texels[index]->data();
  const TexelCorners corners(texture, sample);
  const float* texels[4];
  float weights[4];
  std::size_t count = 0;
  for (int c = 0; c < 4; ++c) {
    if (corners.weight[c] == 0) continue;
    texels[count] = values + corners.texel[c] * texture.values + begin;
    weights[count++] = static_cast<float>(corners.weight[c]);
  }
  blended_.resize(std::size_t{texture.values} + 1);
  kernels_.weighted_sum(texels, weights, count, end - begin, blended_.data() + begin);
  blended_.back() = 0;
}

void SpectralTextures::fill(const KbTextureSample& sample, DenseSpectra& spectra, float* out) {
  const KbTexture& texture = scene_.textures[sample.texture];
  blend(texture, sample.texture, sample);
  if (texture.flags & KB_TEXTURE_BANDS) {
    const BandRows& rows = band_rows(texture.first_row, spectra);
    kernels_.mix_bands(blended_.data(), rows.index.get(), rows.first.get(), rows.second.get(),
                       spectra.channels(), out);
    return;
  }
  members_.clear();
  for (uint32_t p = 0; p < texture.values; ++p) members_.push_back(spectra.spectrum(texture.first_row + p));
  // Whole rows with their padding, so that a channel's bits do not depend on its place.
  kernels_.weighted_sum(members_.data(), blended_.data(), texture.values, pad_channels(spectra.channels()),
                        out);
}

}  // namespace kiloband::cpu
