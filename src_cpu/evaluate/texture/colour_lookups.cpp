#include "src_cpu/evaluate/texture/colour_lookups.hpp"

#include <algorithm>
#include <cmath>

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

/// Their number becomes even.
void add_empty_term(ColourTerms& terms) {
  std::ranges::fill(terms.coefficients[terms.count], 0.0f);
  terms.weights[terms.count++] = 0;
}

void close(ColourTerms& terms, double constant) {
  terms.constant = static_cast<float>(constant);
  if (terms.count % 2 == 1) add_empty_term(terms);
}

}  // namespace

ColourLookups::ColourLookups(const FlatScene& scene, const EvaluatorKernels& kernels)
    : scene_(scene),
      kernels_(kernels),
      first_row_(scene.textures.size(), kNone),
      pool_(scene.channels.size()) {
  std::size_t rows = 0;
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const KbTexture& t = scene.textures[i];
    const std::size_t texels = std::size_t{t.width} * t.height;
    if ((t.flags & (KB_TEXTURE_SPECTRAL | KB_TEXTURE_NORMALS)) || texels > kMostRows - rows) continue;
    first_row_[i] = rows;
    rows += texels;
  }
  rows_.resize(2 * rows);
}

const float* ColourLookups::texel_row(std::size_t number, std::size_t texel, const float* factor,
                                      DenseSpectra& spectra) {
  Row& row = rows_[factor ? rows_.size() / 2 + number : number];
  if (row.generation == generation_) return row.data;
  ColourTerms terms;
  double constant = 0;
  add_texel(terms, constant, scene_.texels[texel], 1);
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
      range.one_group) {  // one path, or one group, does not earn rows of texels
    evaluate(texture, corners, factor, spectra, range, out);
    return out;
  }
  if (generation_ != spectra.generation()) {
    generation_ = spectra.generation();
    pool_.release();
  }
  const std::size_t first = scene_.textures[texture].first_texel;
  const float* rows[4];
  float weights[4];
  std::size_t count = 0;
  for (int c = 0; c < 4; ++c) {
    if (corners.weight[c] == 0) continue;
    const std::size_t texel = corners.texel[c];
    rows[count] = texel_row(first_row_[texture] + texel, first + texel, factor, spectra);
    weights[count++] = static_cast<float>(corners.weight[c]);
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
