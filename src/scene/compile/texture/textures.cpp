#include "scene/compile/texture/textures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/compile/texture/texel_memo.hpp"
#include "spectral/colour/cie_tables.hpp"
#include "spectral/colour/colour.hpp"
#include "spectral/colour/rgb.hpp"

namespace kiloband {
namespace {

// SigmoidTable's coefficients are about the middle of the colour matching functions.
static_assert(KB_TEXTURE_CENTRE_NM == (kCieMinNm + kCieMaxNm) / 2);
constexpr float kFlatCoefficient = 1e10f;  // S(1e10) == 1: a spectrally flat texel, see records.h

KbFloat4 flat_texel(float value) {
  return {0, 0, kFlatCoefficient, value};
}

/// Made for the first colour: that takes 0.2 s, which pictures of numbers have no use for.
const SigmoidTable& sigmoid_table() {
  static const SigmoidTable table;
  return table;
}

/// Reflectance: the sigmoid of the colour. Emission: twice the maximum times the sigmoid
/// of rgb / (2 max), as Mitsuba.
KbFloat4 upsampled_texel(const float* rgb, bool emission) {
  const float largest = std::max({rgb[0], rgb[1], rgb[2]});
  if (largest <= 0) return flat_texel(0);
  if (!emission && rgb[0] == rgb[1] && rgb[1] == rgb[2]) return flat_texel(rgb[0]);
  const float scale = emission ? 2 * largest : 1;
  const auto c = sigmoid_table()({rgb[0] / scale, rgb[1] / scale, rgb[2] / scale});
  return {c[0], c[1], c[2], scale};
}

/// As a reflectance; components above 1 as that much of the brightest one.
KbFloat4 picture_texel(const float* rgb) {
  const float scale = std::max({1.0f, rgb[0], rgb[1], rgb[2]});
  const float part[3] = {rgb[0] / scale, rgb[1] / scale, rgb[2] / scale};
  KbFloat4 texel = upsampled_texel(part, false);
  texel.w *= scale;
  return texel;
}

bool emits(BitmapUse use) {
  return use == BitmapUse::kEmission || use == BitmapUse::kEnvironment;
}

/// Opacities, weights, temperatures, roughness, heights.
bool are_numbers(BitmapUse use) {
  return use == BitmapUse::kOpacity || use == BitmapUse::kRoughness || use == BitmapUse::kHeight;
}

float value_of(const Image& image, std::size_t texel) {
  if (image.channels == 1) return image.pixels[texel];
  return (image.pixels[3 * texel] + image.pixels[3 * texel + 1] + image.pixels[3 * texel + 2]) / 3;
}

}  // namespace

float luminance_of(const float* rgb) {
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return rgb[0];
  return 0.212671f * rgb[0] + 0.715160f * rgb[1] + 0.072169f * rgb[2];
}

void store_uv_transform(const glm::dmat3& to_uv, float (&out)[6]) {
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) out[3 * row + column] = static_cast<float>(to_uv[column][row]);
  }
}

uint32_t first_texel_index(std::size_t before, std::size_t count, const SourcePosition& position,
                           const std::string& name) {
  constexpr std::size_t kMost = std::size_t{1} << 32;
  if (before > kMost || count > kMost - before) {
    throw InputError(position,
                     fmt::format("texture '{}': {} texels after {} of other textures: all textures of a "
                                 "scene may have {} texels together",
                                 name, count, before, kMost));
  }
  return static_cast<uint32_t>(before);
}

TextureCompiler::TextureCompiler(const CompileContext& context)
    : out_(context.out), spectra_(context.spectra), current_(context.mesh) {}

uint32_t TextureCompiler::add_record(const KbTexture& record, double mean, double bound) {
  means_.push_back(mean);
  bounds_.push_back(bound);
  out_.textures.push_back(record);
  return static_cast<uint32_t>(out_.textures.size() - 1);
}

uint32_t TextureCompiler::d65_row() {
  if (peaks_.rgb_row == KB_NONE)
    peaks_.rgb_row = spectra_.row(illuminant_d65(), {"RGB emission (D65)", {}, true});
  return peaks_.rgb_row;
}

uint32_t TextureCompiler::reference(const Texture& texture, const SpectrumSource& use) {
  if (const auto* spectrum = std::get_if<Spectrum>(&texture))
    return KB_REF_SPECTRUM | spectra_.row(*spectrum, use);
  if (const auto* image = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture)) {
    return KB_REF_BITMAP | bitmap(*image, use.emission ? BitmapUse::kEmission : BitmapUse::kReflectance);
  }
  if (const auto* spectral = std::get_if<std::shared_ptr<const SpectralBitmapTexture>>(&texture))
    return KB_REF_BITMAP | spectral_bitmap(*spectral, use);
  if (const auto* attribute = std::get_if<std::shared_ptr<const MeshAttributeTexture>>(&texture))
    return KB_REF_BITMAP | mesh_attribute(*attribute, use);
  return KB_REF_CHECKERBOARD |
         checkerboard(std::get<std::shared_ptr<const CheckerboardTexture>>(texture), use);
}

/// A texel that is not flat.
KbFloat4 TextureCompiler::texel_of(const float* rgb, BitmapUse use, float height) {
  if (use == BitmapUse::kRoughness) return flat_texel(luminance_of(rgb));
  if (use == BitmapUse::kHeight) return flat_texel(height * luminance_of(rgb));
  if (use == BitmapUse::kNormals) return {2 * rgb[0] - 1, 2 * rgb[1] - 1, 2 * rgb[2] - 1, 1};
  if (use == BitmapUse::kPicture) return picture_texel(rgb);
  return upsampled_texel(rgb, emits(use));
}

const TexelBlock& TextureCompiler::texels(const BitmapTexture& texture, BitmapUse use, float height) {
  const auto [place, is_new] = blocks_.try_emplace({texture.image, use, height, texture.raw});
  TexelBlock& block = place->second;
  if (!is_new) return block;
  const Image& image = *texture.image;
  const std::size_t count = std::size_t{image.width} * image.height;
  const bool numbers = are_numbers(use);
  if (!numbers) block.first_texel = static_cast<uint32_t>(out_.texels.size());  // never more than bounds
  block.first_bound = first_texel_index(out_.texel_bounds.size(), count, texture.position,
                                        texture.id.empty() ? texture.file.string() : texture.id);
  const bool geometry =
      use == BitmapUse::kRoughness || use == BitmapUse::kHeight || use == BitmapUse::kNormals;
  const bool flat =
      !geometry && (texture.raw || use == BitmapUse::kOpacity || (image.channels == 1 && !emits(use)));
  const bool share = use == BitmapUse::kOpacity && image.channels == 3;
  TexelMemo memo(count);
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float value = share ? luminance_of(&image.pixels[3 * i]) : value_of(image, i);
    const float grey[3] = {value, value, value};
    const float* rgb = flat || image.channels == 1 ? grey : &image.pixels[3 * i];
    const SolvedTexel& solved = memo.find(rgb, [&] {
      const KbFloat4 texel = flat ? flat_texel(value) : texel_of(rgb, use, height);
      return SolvedTexel{texel, texel_bound(texel)};
    });
    if (!numbers) out_.texels.push_back(solved.texel);
    out_.texel_bounds.push_back(solved.bound);
    sum += value;
    block.bound = std::max(block.bound, double{solved.bound});
    block.peak = std::max(block.peak, double{solved.texel.w});
  }
  block.mean = sum / static_cast<double>(count);
  return block;
}

uint32_t TextureCompiler::bitmap(const std::shared_ptr<const BitmapTexture>& texture, BitmapUse use,
                                 float height) {
  const auto [place, is_new] =
      bitmaps_.try_emplace({texture, use, height}, static_cast<uint32_t>(out_.textures.size()));
  if (!is_new) return place->second;
  const bool emission = emits(use);
  out_.features.bitmap = true;
  const TexelBlock& block = texels(*texture, use, height);
  KbTexture record{};
  record.width = texture->image->width;
  record.height = texture->image->height;
  record.first_texel = block.first_texel;
  record.first_bound = block.first_bound;
  record.wrap = static_cast<uint32_t>(texture->wrap);
  record.flags = texture->nearest ? KB_TEXTURE_NEAREST : 0;
  if (use == BitmapUse::kNormals) record.flags |= KB_TEXTURE_NORMALS;
  if (are_numbers(use)) record.flags |= KB_TEXTURE_NUMBERS;
  record.illuminant_row = emission && !texture->raw ? d65_row() : KB_NONE;
  store_uv_transform(texture->to_uv, record.to_uv);
  double& peak = texture->raw ? peaks_.raw : peaks_.rgb;
  if (emission) peak = std::max(peak, block.peak);
  add_record(record, block.mean, block.bound);
  return place->second;
}

/// The sigmoid is monotonic in a parabola: its extremes are at the ends of the range or at the vertex.
float TextureCompiler::texel_bound(const KbFloat4& texel) const {
  if (texel.x == 0 && texel.y == 0) return texel.w;
  const Channel channels = hull(out_.channels), guide = hull(out_.guide);
  const auto from_centre = [](double nm) {
    return std::clamp(nm, kCieMinNm, kCieMaxNm) - KB_TEXTURE_CENTRE_NM;
  };
  const double low = from_centre(std::min(channels.min_nm, guide.min_nm));
  const double high = from_centre(std::max(channels.max_nm, guide.max_nm));
  const auto value = [&](double y) {
    const double v = (texel.x * y + texel.y) * y + texel.z;
    return 0.5 + 0.5 * v / std::sqrt(1 + v * v);
  };
  double largest = std::max(value(low), value(high));
  const double vertex = -0.5 * texel.y / texel.x;
  if (texel.x != 0 && vertex > low && vertex < high) largest = std::max(largest, value(vertex));
  return static_cast<float>(texel.w * largest);
}

uint32_t TextureCompiler::checkerboard(const std::shared_ptr<const CheckerboardTexture>& texture,
                                       const SpectrumSource& use) {
  const auto [place, is_new] = checkerboards_.try_emplace({texture.get(), use.emission},
                                                          static_cast<uint32_t>(out_.checkerboards.size()));
  if (!is_new) return place->second;
  out_.features.checkerboard = true;
  KbCheckerboard record{};
  record.ref0 = spectra_.row(texture->color0, {use.name + " color0", texture->position, use.emission});
  record.ref1 = spectra_.row(texture->color1, {use.name + " color1", texture->position, use.emission});
  store_uv_transform(texture->to_uv, record.to_uv);
  out_.checkerboards.push_back(record);
  return place->second;
}

uint32_t TextureCompiler::texels_of(const Texture& texture) {
  if (const auto* image = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture))
    return bitmap(*image, BitmapUse::kReflectance);
  if (const auto* spectral = std::get_if<std::shared_ptr<const SpectralBitmapTexture>>(&texture))
    return spectral_bitmap(*spectral, {});
  return mesh_attribute(std::get<std::shared_ptr<const MeshAttributeTexture>>(texture), {});
}

double TextureCompiler::mean(const Texture& texture) {
  if (const auto* spectrum = std::get_if<Spectrum>(&texture)) return spectra_.guide_mean(*spectrum);
  if (const auto* board = std::get_if<std::shared_ptr<const CheckerboardTexture>>(&texture))
    return 0.5 * (spectra_.guide_mean((*board)->color0) + spectra_.guide_mean((*board)->color1));
  return means_[texels_of(texture)];
}

double TextureCompiler::bound(const Texture& texture) {
  if (const auto* spectrum = std::get_if<Spectrum>(&texture)) return spectra_.bound(*spectrum);
  if (const auto* board = std::get_if<std::shared_ptr<const CheckerboardTexture>>(&texture))
    return std::max(spectra_.bound((*board)->color0), spectra_.bound((*board)->color1));
  return bounds_[texels_of(texture)];
}

}  // namespace kiloband
