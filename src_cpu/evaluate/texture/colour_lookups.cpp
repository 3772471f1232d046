#include "src_cpu/evaluate/texture/colour_lookups.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <span>

namespace kiloband::cpu {
namespace {

/// One term of a lookup. A flat texel is evaluated here, in double: S(1e10) is exactly 1.
void add_texel(ColourTerms& terms, double& constant, const KbFloat4& texel, double weight) {
  if (weight == 0) return;
  if (texel.x == 0 && texel.y == 0) {
    const double v = texel.z;
    constant += weight * texel.w * (0.5 + 0.5 * v / std::sqrt(1 + v * v));
    return;
  }
  const uint32_t i = terms.count++;
  terms.coefficients[i][0] = texel.x;
  terms.coefficients[i][1] = texel.y;
  terms.coefficients[i][2] = texel.z;
  terms.weights[i] = static_cast<float>(weight * texel.w);
}

/// What terms have in common; their number becomes even.
void close(ColourTerms& terms, double constant) {
  terms.constant = static_cast<float>(constant);
  if (terms.count % 2 == 0) return;
  std::ranges::fill(terms.coefficients[terms.count], 0.0f);
  terms.weights[terms.count++] = 0;
}

/// Numbers texels by their colours, up to a factor, from colours.size() on; new colours go behind the others. False: there are more than
/// `most`, and nothing is changed.
bool number_colours(std::span<const KbFloat4> texels, std::size_t most, std::vector<KbFloat4>& colours,
                    std::vector<uint32_t>& numbers) {
  std::map<std::array<uint32_t, 3>, uint32_t> known;
  const std::size_t before = numbers.size(), colours_before = colours.size();
  for (const KbFloat4& texel : texels) {
    const std::array<uint32_t, 3> bits{std::bit_cast<uint32_t>(texel.x), std::bit_cast<uint32_t>(texel.y),
                                       std::bit_cast<uint32_t>(texel.z)};
    const auto [found, is_new] = known.try_emplace(bits, static_cast<uint32_t>(colours.size()));
    if (is_new) colours.push_back({texel.x, texel.y, texel.z, 1});
    if (colours.size() > most) {
      numbers.resize(before);
      colours.resize(colours_before);
      return false;
    }
    numbers.push_back(found->second);
  }
  return true;
}

}  // namespace

ColourLookups::ColourLookups(const FlatScene& scene, const EvaluatorKernels& kernels)
    : scene_(scene), kernels_(kernels), first_(scene.textures.size(), kNone), pool_(scene.channels.size()) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const KbTexture& t = scene.textures[i];
    const std::size_t texels = std::size_t{t.width} * t.height, first = row_of_.size();
    constexpr uint32_t kNoColours = KB_TEXTURE_SPECTRAL | KB_TEXTURE_NORMALS | KB_TEXTURE_NUMBERS;
    if ((t.flags & kNoColours) || texels > kMostTexels) continue;
    if (number_colours(std::span(scene.texels).subspan(t.first_texel, texels), kMostRows, colours_, row_of_))
      first_[i] = first;
  }
  rows_.resize(2 * colours_.size());
}

const float* ColourLookups::colour_row(std::size_t number, const float* factor, DenseSpectra& spectra) {
  Row& row = rows_[factor ? colours_.size() + number : number];
  if (row.generation == generation_) return row.data;
  ColourTerms terms;
  double constant = 0;
  add_texel(terms, constant, colours_[number], 1);
  close(terms, constant);
  terms.factor = factor;
  float* const out = pool_.take();
  kernels_.colour_row(terms, spectra.texture_offsets(), spectra.channels(), out);
  row = {generation_, out};
  return out;
}

const float* ColourLookups::row(uint32_t texture, const TexelCorners& corners, const float* factor,
                                DenseSpectra& spectra, ChannelRange range, float* out) {
  if (!has_rows(texture) || spectra.fast() ||
      range.one_group) {  // one path, or one group, does not earn rows of colours
    evaluate(texture, corners, factor, spectra, range, out);
    return out;
  }
  if (generation_ != spectra.generation()) {
    generation_ = spectra.generation();
    pool_.release();
  }
  const KbFloat4* const texels = &scene_.texels[scene_.textures[texture].first_texel];
  const uint32_t* const row_of = &row_of_[first_[texture]];
  uint32_t numbers[4];
  double sums[4];
  std::size_t count = 0;
  for (int c = 0; c < 4; ++c) {
    const double weight = corners.weight[c] * double{texels[corners.texel[c]].w};
    if (weight == 0) continue;
    const uint32_t number = row_of[corners.texel[c]];
    const std::size_t at = static_cast<std::size_t>(std::find(numbers, numbers + count, number) - numbers);
    if (at == count) {
      numbers[count] = number;
      sums[count++] = 0;
    }
    sums[at] += weight;
  }
  const float* rows[4];
  float weights[4];
  for (std::size_t i = 0; i < count; ++i) {
    rows[i] = colour_row(numbers[i], factor, spectra);
    weights[i] = static_cast<float>(sums[i]);
  }
  if (count == 1 && weights[0] == 1) return rows[0];
  kernels_.weighted_sum(rows, weights, count, spectra.padded_channels(), out);
  return out;
}

void ColourLookups::evaluate(uint32_t texture, const TexelCorners& corners, const float* factor,
                             DenseSpectra& spectra, ChannelRange range, float* out) const {
  const std::size_t first = scene_.textures[texture].first_texel;
  ColourTerms terms;
  double constant = 0;
  for (int c = 0; c < 4; ++c)
    add_texel(terms, constant, scene_.texels[first + corners.texel[c]], corners.weight[c]);
  close(terms, constant);
  const auto [begin, end, one_group] = range;
  ColourOffsets offsets = spectra.texture_offsets();
  if (one_group)  // does not earn the nodes of cells
    offsets = {offsets.nm + begin, std::clamp(offsets.distinct, begin, end) - begin, nullptr};
  terms.factor = factor ? factor + begin : nullptr;
  kernels_.colour_row(terms, offsets, end - begin, out + begin);
}

}  // namespace kiloband::cpu
