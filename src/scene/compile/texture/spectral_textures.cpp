// Spectral textures and environments: band sets, endmembers, bounds, and what light selection needs to know.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scene/compile/spectra/band_set.hpp"
#include "scene/compile/spectra/spectral_values.hpp"
#include "scene/compile/texture/textures.hpp"

namespace kiloband {
namespace {

BandSet band_set_of(const SpectralImage& image, bool extrapolate, bool emission, double scale) {
  BandSet set;
  set.min_nm = std::numeric_limits<double>::infinity();
  for (const Channel& band : image.bands) {
    set.centres_nm.push_back(band.centre_nm());
    set.min_nm = std::min(set.min_nm, band.min_nm);
    set.max_nm = std::max(set.max_nm, band.max_nm);
  }
  set.extrapolate = extrapolate;
  set.is_emission = emission;
  set.scale = scale;
  return set;
}

}  // namespace

uint32_t TextureCompiler::spectral_bitmap(const std::shared_ptr<const SpectralBitmapTexture>& texture,
                                          const SpectrumSource& use) {
  const auto [place, is_new] = spectral_bitmaps_.try_emplace({texture.get(), use.emission},
                                                             static_cast<uint32_t>(out_.textures.size()));
  if (is_new) {
    out_.features.bitmap = true;
    add_spectral_texture(*texture, use, 1);
  }
  return place->second;
}

uint32_t TextureCompiler::add_spectral_texture(const SpectralBitmapTexture& texture,
                                               const SpectrumSource& use, double scale) {
  out_.features.spectral_texture = true;
  const SpectralImage& image = *texture.image;
  const std::size_t count = std::size_t{image.width} * image.height;
  KbTexture record{};
  record.width = image.width;
  record.height = image.height;
  record.wrap = static_cast<uint32_t>(texture.wrap);
  record.flags = (texture.nearest ? KB_TEXTURE_NEAREST : 0) |
                 (texture.endmembers.empty() ? KB_TEXTURE_BANDS : KB_TEXTURE_WEIGHTS);
  record.illuminant_row = KB_NONE;
  store_uv_transform(texture.to_uv, record.to_uv);
  record.first_bound = first_texel_index(out_.texel_bounds.size(), count, texture.position,
                                         texture.id.empty() ? image.file.string() : texture.id);
  record.values = image.values_per_pixel;
  record.first_value = first_value_unit(image, texture.position);
  const auto index = static_cast<uint32_t>(out_.textures.size());
  if (texture.endmembers.empty())
    add_bands(record, texture, use, scale);
  else
    add_weights(record, texture, use);
  out_.spectral_texels.resize(index + 1);
  out_.spectral_texels[index] = image.values;
  out_.textures.push_back(record);
  return index;
}

/// Where the image's values begin on a device.
uint32_t TextureCompiler::first_value_unit(const SpectralImage& image, const SourcePosition& position) {
  const uint64_t first = value_units_;
  value_units_ += (image.values->size() + KB_VALUE_UNIT - 1) / KB_VALUE_UNIT;
  if (value_units_ > std::numeric_limits<uint32_t>::max())
    throw InputError(position,
                     image.file.string() + ": the spectral images of a scene are larger than 256 GiB");
  return static_cast<uint32_t>(first);
}

void TextureCompiler::add_bands(KbTexture& record, const SpectralBitmapTexture& texture,
                                const SpectrumSource& use, double scale) {
  const SpectralImage& image = *texture.image;
  const BandSet set = band_set_of(image, texture.extrapolate, use.emission, scale);
  spectra_.check_range({{set.min_nm, set.max_nm}}, set.extrapolate, use);
  record.first_row = static_cast<uint32_t>(out_.band_sets.size());
  out_.band_sets.push_back(set);

  // What the guide bands see on average, and which bands anything sees at all.
  std::vector<double> guide(set.centres_nm.size(), 0.0);
  for (const Channel& band : out_.guide) add_mean_weights(set, band, guide);
  std::vector<double> seen = guide;
  for (const Channel& channel : out_.channels) add_mean_weights(set, channel, seen);
  const std::size_t count = std::size_t{image.width} * image.height;
  float largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const float> values = texel(image, i);
    float bound = 0;
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (seen[v] > 0) bound = std::max(bound, values[v]);
    }
    out_.texel_bounds.push_back(static_cast<float>(bound * scale));
    largest = std::max(largest, out_.texel_bounds.back());
  }
  const ValueStatistics statistics(image, std::vector<double>(image.height, 1.0));
  double mean = 0;
  for (std::size_t v = 0; v < guide.size(); ++v)
    mean += statistics.mean[v] * guide[v] * scale / static_cast<double>(out_.guide.size());
  means_.push_back(mean);
  bounds_.push_back(largest);
  colours_[static_cast<uint32_t>(out_.textures.size())] = {{band_spectrum(set, statistics.mean), 1.0}};
  if (use.emission) peaks_.spectra.push_back(band_spectrum(set, statistics.largest));
}

/// The rows of a texture's endmembers follow each other; weights need no unit.
void TextureCompiler::add_weights(KbTexture& record, const SpectralBitmapTexture& texture,
                                  const SpectrumSource& use) {
  const SpectralImage& image = *texture.image;
  const ValueStatistics statistics(image, std::vector<double>(image.height, 1.0));
  record.first_row = static_cast<uint32_t>(out_.spectra.size());
  std::vector<double> bounds;
  double mean = 0;
  auto& colour = colours_[static_cast<uint32_t>(out_.textures.size())];
  for (std::size_t p = 0; p < texture.endmembers.size(); ++p) {
    const Spectrum& spectrum = texture.endmembers[p];
    const uint32_t row = spectra_.new_row(
        spectrum, {fmt::format("{} endmember_{}", use.name, p), texture.position, use.emission});
    bounds.push_back(out_.spectra[row].bound);
    mean += statistics.mean[p] * spectra_.guide_mean(spectrum);
    colour.emplace_back(spectrum, statistics.mean[p]);
    if (use.emission) peaks_.row_factors[row] = statistics.largest[p];
  }
  const std::size_t count = std::size_t{image.width} * image.height;
  float largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // Mixtures of reflectances are checked to be at most 1 when they are read.
    const auto bound = static_cast<float>(dot(texel(image, i), bounds));
    out_.texel_bounds.push_back(use.emission ? bound : std::min(bound, 1.0f));
    largest = std::max(largest, out_.texel_bounds.back());
  }
  means_.push_back(mean);
  bounds_.push_back(largest);
}

}  // namespace kiloband
