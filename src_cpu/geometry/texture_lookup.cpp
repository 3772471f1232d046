// Texture addressing. A KbTextureSample stores the first texel of a 2x2 block after wrapping; its reader
// finds the second by adding 1 and wrapping again. Where wrapping turns the order around (mirror) or repeats
// a texel (the ends of mirror and clamp) the block is stored so that this reading gives the same value.
#include "src_cpu/geometry/texture_lookup.hpp"

#include <algorithm>
#include <cmath>

#include "shared/estimator.h"

namespace kiloband::cpu {
namespace {

/// One axis of a lookup: first texel and weight of the second.
struct AxisSample {
  uint32_t first;
  float fraction;
};

/// uv' = M (u, v, 1), in double: the fraction of a texel survives large repeat counts.
glm::dvec2 apply_to_uv(const float (&m)[6], glm::vec2 uv) {
  const double u = uv.x, v = uv.y;
  return {m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]};
}

/// x modulo period for integral x; exact below 2^53.
double wrap_period(double x, double period) {
  return x - period * std::floor(x / period);
}

double usable(double x) {
  return std::fabs(x) < double{KB_LARGEST_COORDINATE} ? x : 0;
}

AxisSample wrap_clamp(double x, uint32_t size) {
  const double last = size - 1.0;
  const double inside = x > 0 ? std::fmin(x, last) : 0;  // NaN: 0
  const double first = std::floor(inside);
  return {static_cast<uint32_t>(first), static_cast<float>(inside - first)};
}

AxisSample wrap_repeat(double x, uint32_t size) {
  const double floor_x = std::floor(usable(x));
  return {static_cast<uint32_t>(wrap_period(floor_x, size)), static_cast<float>(usable(x) - floor_x)};
}

/// The period is 2 * size: texels 0 .. size-1, then size-1 .. 0.
AxisSample wrap_mirror(double x, uint32_t size) {
  const double floor_x = std::floor(usable(x));
  const float fraction = static_cast<float>(usable(x) - floor_x);
  const auto i = static_cast<uint32_t>(wrap_period(floor_x, 2.0 * size));
  if (i + 1 < size) return {i, fraction};
  if (i + 1 == size) return {i, 0};         // size-1 and size-1 again
  if (i + 1 == 2 * size) return {0, 0};     // 0 and 0 again
  return {2 * size - 2 - i, 1 - fraction};  // 2*size-1-i and its predecessor, stored in ascending order
}

/// x: coordinate in texels with texel i at x = i.
AxisSample wrap_linear(double x, uint32_t size, uint32_t wrap) {
  if (wrap == KB_WRAP_CLAMP) return wrap_clamp(x, size);
  return wrap == KB_WRAP_MIRROR ? wrap_mirror(x, size) : wrap_repeat(x, size);
}

/// x: coordinate in texels with texel i on [i, i+1).
uint32_t wrap_nearest(double x, uint32_t size, uint32_t wrap) {
  if (wrap == KB_WRAP_CLAMP) return wrap_clamp(std::floor(x), size).first;
  const double i = std::floor(usable(x));
  if (wrap == KB_WRAP_REPEAT) return static_cast<uint32_t>(wrap_period(i, size));
  const auto j = static_cast<uint32_t>(wrap_period(i, 2.0 * size));
  return j < size ? j : 2 * size - 1 - j;
}

uint32_t pack(uint32_t x, uint32_t y) {
  return x | y << 16;
}

}  // namespace

KbTextureSample sample_bitmap(const KbTexture& texture, uint32_t index, glm::vec2 uv) {
  const glm::dvec2 texels = apply_to_uv(texture.to_uv, uv) * glm::dvec2(texture.width, texture.height);
  if (texture.flags & KB_TEXTURE_NEAREST) {
    return {index,
            pack(wrap_nearest(texels.x, texture.width, texture.wrap),
                 wrap_nearest(texels.y, texture.height, texture.wrap)),
            0, 0};
  }
  const AxisSample x = wrap_linear(texels.x - 0.5, texture.width, texture.wrap);
  const AxisSample y = wrap_linear(texels.y - 0.5, texture.height, texture.wrap);
  return {index, pack(x.first, y.first), x.fraction, y.fraction};
}

KbTextureSample sample_envmap_texture(const KbTexture& texture, uint32_t index, glm::vec2 uv) {
  const AxisSample x = wrap_repeat(static_cast<double>(uv.x) * texture.width - 0.5, texture.width);
  const AxisSample y = wrap_clamp(static_cast<double>(uv.y) * (texture.height - 1.0), texture.height);
  return {index, pack(x.first, y.first), x.fraction, y.fraction};
}

ResolvedSpectrum resolve_spectrum(const FlatScene& scene, uint32_t ref, glm::vec2 uv) {
  ResolvedSpectrum resolved;
  const uint32_t index = ref & KB_REF_INDEX_MASK;
  switch (ref & KB_REF_KIND_MASK) {
    case KB_REF_BITMAP:
      resolved.textured = true;
      resolved.texture = sample_bitmap(scene.textures[index], index, uv);
      break;
    case KB_REF_CHECKERBOARD: {
      // ref0 where both coordinates are in the same half of their period, ref1 elsewhere (Mitsuba's order).
      const KbCheckerboard& board = scene.checkerboards[index];
      const glm::dvec2 p = apply_to_uv(board.to_uv, uv);
      const bool same = (p.x - std::floor(p.x) > 0.5) == (p.y - std::floor(p.y) > 0.5);
      resolved.row = static_cast<uint16_t>((same ? board.ref0 : board.ref1) & KB_REF_INDEX_MASK);
      break;
    }
    default:
      resolved.row = static_cast<uint16_t>(index);
  }
  return resolved;
}

namespace {

/// Indices of the four texels of a lookup, from the texture's `first` on. A second texel beyond the end has
/// weight 0 unless the texture repeats.
struct Corners {
  std::size_t at[4];  // (x0, y0) (x1, y0) (x0, y1) (x1, y1)
};

Corners corners_of(const KbTexture& texture, std::size_t first, const KbTextureSample& sample) {
  const uint32_t x0 = sample.xy & 0xffffu, y0 = sample.xy >> 16;
  const bool repeat_x = texture.wrap == KB_WRAP_REPEAT || (texture.flags & KB_TEXTURE_ENVMAP) != 0;
  const bool repeat_y = texture.wrap == KB_WRAP_REPEAT && (texture.flags & KB_TEXTURE_ENVMAP) == 0;
  const uint32_t x1 = x0 + 1 < texture.width ? x0 + 1 : (repeat_x ? 0 : x0);
  const uint32_t y1 = y0 + 1 < texture.height ? y0 + 1 : (repeat_y ? 0 : y0);
  const std::size_t row0 = first + static_cast<std::size_t>(y0) * texture.width;
  const std::size_t row1 = first + static_cast<std::size_t>(y1) * texture.width;
  return {{row0 + x0, row0 + x1, row1 + x0, row1 + x1}};
}

}  // namespace

float bitmap_value(const FlatScene& scene, const KbTextureSample& sample) {
  const KbTexture& texture = scene.textures[sample.texture];
  const Corners c = corners_of(texture, texture.first_texel, sample);
  const float top = (1 - sample.fx) * scene.texels[c.at[0]].w + sample.fx * scene.texels[c.at[1]].w;
  const float bottom = (1 - sample.fx) * scene.texels[c.at[2]].w + sample.fx * scene.texels[c.at[3]].w;
  return (1 - sample.fy) * top + sample.fy * bottom;
}

float share_at(const FlatScene& scene, uint32_t ref, float constant, glm::vec2 uv) {
  if (ref == KB_NONE) return constant;
  const ResolvedSpectrum value = resolve_spectrum(scene, ref, uv);
  return std::clamp(bitmap_value(scene, value.texture), 0.0f, 1.0f);
}

const KbSurface& blended_surface(const FlatScene& scene, const KbSurface& blend, glm::vec2 uv, float& u) {
  const KbSurface* surface = &blend;
  while (surface->flags & KB_SURFACE_BLEND) {
    const float weight = share_at(scene, surface->weight_ref, surface->weight, uv);
    const bool second = u < weight;
    u = std::min(second ? u / weight : (u - weight) / (1 - weight), KB_ONE_MINUS_EPSILON);
    surface = &scene.surfaces[second ? surface->second : surface->first];
  }
  return *surface;
}

float texel_bound(const FlatScene& scene, uint32_t index, uint32_t xy) {
  const KbTexture& texture = scene.textures[index];
  const Corners c = corners_of(texture, texture.first_bound, {index, xy, 0, 0});
  return std::max({scene.texel_bounds[c.at[0]], scene.texel_bounds[c.at[1]], scene.texel_bounds[c.at[2]],
                   scene.texel_bounds[c.at[3]]});
}

float spectrum_bound(const FlatScene& scene, const ResolvedSpectrum& spectrum) {
  if (!spectrum.textured) return scene.spectra[spectrum.row].bound;
  return texel_bound(scene, spectrum.texture.texture, spectrum.texture.xy);
}

}  // namespace kiloband::cpu
