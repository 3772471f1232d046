// Texture addressing: texture_lookup.hpp in lanes, for a texture that all lanes share.
//
// A KbTextureSample stores the first texel of a 2x2 block after wrapping; its reader finds the second by adding 1 and
// wrapping again. Where wrapping turns the order around (mirror) or repeats a texel (the ends of mirror and clamp) the block
// is stored so that this reading gives the same value.
//
// Coordinates are in double: the fraction of a texel survives large repeat counts.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_TEXTURE_LOOKUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_TEXTURE_LOOKUP_INL
#undef KILOBAND_TEXTURE_LOOKUP_INL
#else
#define KILOBAND_TEXTURE_LOOKUP_INL
#endif

#include "scene/compile/flat_scene.hpp"
#include "shared/estimator.h"
#include "src_cpu/lanes/lane_access-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// KbTextureSample in lanes.
struct TextureSample {
  U texture, xy;
  F fx, fy;
};

/// One axis of a lookup: first texel, a whole number, and weight of the second.
struct AxisSample {
  F first, fraction;
};

KB_INLINE TextureSample texture_sample(uint32_t texture, const AxisSample& x, const AxisSample& y) {
  return {U(texture), to_words(x.first) | shift_left<16>(to_words(y.first)), x.fraction, y.fraction};
}

// ---- one axis; x: coordinate in texels with texel i at x = i, or on [i, i + 1) where texels are not interpolated ----------

/// whole modulo period for integral numbers, in [0, period); exact below KB_LARGEST_COORDINATE.
KB_INLINE F wrap_period(D whole, double period) {
  return to_floats(whole - to_doubles(period) * floor(whole / to_doubles(period)));
}

KB_INLINE D usable(D x) {
  return zero_beyond(x, double{KB_LARGEST_COORDINATE});
}

/// NaN: 0
KB_INLINE AxisSample wrap_clamp(D x, uint32_t size) {
  const D inside = min(max(x, to_doubles(0.0)), to_doubles(size - 1.0));
  const D first = floor(inside);
  return {to_floats(first), to_floats(inside - first)};
}

KB_INLINE AxisSample wrap_repeat(D x, uint32_t size) {
  const D near = usable(x), first = floor(near);
  return {wrap_period(first, size), to_floats(near - first)};
}

/// The period is 2 * size: texels 0 .. size-1, then size-1 .. 0, which are stored in ascending order. Between size-1 and
/// size-1, and 0 and 0, there is one texel twice.
KB_INLINE AxisSample wrap_mirror(D x, uint32_t size) {
  const D near = usable(x), whole = floor(near);
  const F fraction = to_floats(near - whole), i = wrap_period(whole, 2.0 * size);
  const F last(static_cast<float>(size - 1)), end(static_cast<float>(2 * size - 1));
  const F turned = select((i == last) | (i == end), F(0), F(1) - fraction);
  return {select(i <= last, i, max(end - F(1) - i, F(0))), select(i < last, fraction, turned)};
}

KB_INLINE AxisSample wrap_linear(D x, uint32_t size, uint32_t wrap) {
  if (wrap == KB_WRAP_CLAMP) return wrap_clamp(x, size);
  return wrap == KB_WRAP_MIRROR ? wrap_mirror(x, size) : wrap_repeat(x, size);
}

KB_INLINE AxisSample wrap_nearest(D x, uint32_t size, uint32_t wrap) {
  if (wrap == KB_WRAP_CLAMP) return {wrap_clamp(floor(x), size).first, F(0)};
  const D whole = floor(usable(x));
  if (wrap == KB_WRAP_REPEAT) return {wrap_period(whole, size), F(0)};
  const F i = wrap_period(whole, 2.0 * size);
  return {select(i < F(static_cast<float>(size)), i, F(static_cast<float>(2 * size - 1)) - i), F(0)};
}

// ---- lookups -----------------------------------------------------------------------------------------

/// A row of uv' = M (u, v, 1).
KB_INLINE D row_of_uv(const float* m, V2 uv) {
  return to_doubles(double{m[0]}) * to_doubles(uv.x) + to_doubles(double{m[1]}) * to_doubles(uv.y) +
         to_doubles(double{m[2]});
}

KB_INLINE TextureSample sample_bitmap(const KbTexture& texture, uint32_t index, V2 uv) {
  const uint32_t width = texture.width, height = texture.height, wrap = texture.wrap;
  const D x = row_of_uv(texture.to_uv, uv) * to_doubles(double(width));
  const D y = row_of_uv(texture.to_uv + 3, uv) * to_doubles(double(height));
  if (texture.flags & KB_TEXTURE_NEAREST)
    return texture_sample(index, wrap_nearest(x, width, wrap), wrap_nearest(y, height, wrap));
  const D half = to_doubles(0.5);
  return texture_sample(index, wrap_linear(x - half, width, wrap), wrap_linear(y - half, height, wrap));
}

/// KB_TEXTURE_TRIANGLES: triangle, and the weights of its second and third vertex.
KB_INLINE TextureSample sample_triangles(const KbTexture& texture, uint32_t index, U triangle, V2 weights) {
  const U x = triangle & U(KB_TRIANGLES_ACROSS - 1), y = shift_right<15>(triangle);
  static_assert(KB_TRIANGLES_ACROSS == 1u << 15);
  if (texture.flags & KB_TEXTURE_NEAREST) return {U(index), x | shift_left<16>(y), F(0), F(0)};
  const U xy = shift_left<1>(x) | shift_left<17>(y);
  const F rest = F(1) - weights.y, fx = min(max(weights.x / rest, F(0)), F(1));
  return {U(index), xy, select(rest > F(0), fx, F(0)), min(max(weights.y, F(0)), F(1))};
}

/// The row of ref0 where both coordinates are in the same half of their period, that of ref1 elsewhere (Mitsuba's order).
KB_INLINE U checkerboard_row(const KbCheckerboard& board, V2 uv) {
  const auto second_half = [&](const float* m) KB_LAMBDA {
    const D x = row_of_uv(m, uv);
    return to_floats(x - floor(x) - to_doubles(0.5)) > F(0);
  };
  const M second = second_half(board.to_uv + 3);
  const M same = select(second_half(board.to_uv), second, !second);
  return select(same, U(board.ref0 & KB_REF_INDEX_MASK), U(board.ref1 & KB_REF_INDEX_MASK));
}

/// The four texels of a lookup: (x0, y0) (x1, y0) (x0, y1) (x1, y1), counted from the texture's `first` on. A second texel
/// beyond the end has weight 0 unless the texture repeats.
struct Corners {
  U at[4];
};
KB_INLINE Corners corners_of(const KbTexture& texture, uint32_t first, U xy) {
  const auto second = [](U x, uint32_t size, bool repeats) KB_LAMBDA {
    const U next = x + U(1u);
    return select(next == U(size), repeats ? U(0u) : x, next);
  };
  const bool environment = (texture.flags & KB_TEXTURE_ENVMAP) != 0, repeat = texture.wrap == KB_WRAP_REPEAT;
  const U x0 = xy & U(0xffffu), y0 = shift_right<16>(xy);
  const U x1 = second(x0, texture.width, repeat || environment);
  const U y1 = second(y0, texture.height, repeat && !environment);
  const U row0 = U(first) + y0 * U(texture.width), row1 = U(first) + y1 * U(texture.width);
  return {{row0 + x0, row0 + x1, row1 + x0, row1 + x1}};
}

/// The largest bound of a lookup's four texels.
KB_INLINE F texel_bounds(const FlatScene& scene, uint32_t texture, U xy) {
  const Corners c = corners_of(scene.textures[texture], scene.textures[texture].first_bound, xy);
  const auto bound = [&](int corner)
                         KB_LAMBDA { return gather_from_large(scene.texel_bounds.data(), c.at[corner]); };
  return max(max(bound(0), bound(1)), max(bound(2), bound(3)));
}

/// The environment map's sample for local coordinates u in [0,1) (periodic), v in [0,1] (rows align-corners).
KB_INLINE TextureSample sample_envmap_texture(const KbTexture& texture, uint32_t index, V2 uv) {
  const D x = to_doubles(uv.x) * to_doubles(double(texture.width)) - to_doubles(0.5);
  const D first = floor(x);  // -1 .. width - 1
  const F column = to_floats(first);
  const AxisSample along{select(column < F(0), F(static_cast<float>(texture.width - 1)), column),
                         to_floats(x - first)};
  return texture_sample(index, along,
                        wrap_clamp(to_doubles(uv.y) * to_doubles(texture.height - 1.0), texture.height));
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
