// Texture addressing: texture_lookup.hpp in lanes, each of which may have a texture of its own.
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

#include <bit>

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

/// Of records of textures what lookups need.
struct Textures {
  U width, height, first_texel, wrap, flags, first_bound;
  F to_uv[6];

  /// The same in each lane.
  KB_INLINE explicit Textures(const KbTexture& one)
      : width(one.width),
        height(one.height),
        first_texel(one.first_texel),
        wrap(one.wrap),
        flags(one.flags),
        first_bound(one.first_bound),
        to_uv{F(one.to_uv[0]), F(one.to_uv[1]), F(one.to_uv[2]),
              F(one.to_uv[3]), F(one.to_uv[4]), F(one.to_uv[5])} {}
  KB_INLINE Textures(const KbTexture* textures, U index) {
    static_assert(offsetof(KbTexture, width) == 0 && offsetof(KbTexture, wrap) == 12 &&
                  offsetof(KbTexture, flags) == 16 && offsetof(KbTexture, to_uv) == 24);
    const Addresses records(textures, index);
    U words[3][4];
    for (uint32_t i = 0; i < 3; ++i) records.load(16 * i, words[i]);
    width = words[0][0], height = words[0][1], first_texel = words[0][2], wrap = words[0][3];
    flags = words[1][0];
    for (uint32_t i = 0; i < 6; ++i) to_uv[i] = as_floats(words[(i + 6) / 4][(i + 6) % 4]);
    first_bound = KB_GATHER_WORD(textures, KbTexture, first_bound, index);
  }
};
/// Of checkerboards.
struct Boards {
  U ref0, ref1;
  F to_uv[6];

  KB_INLINE explicit Boards(const KbCheckerboard& one) : ref0(one.ref0), ref1(one.ref1) {
    for (uint32_t i = 0; i < 6; ++i) to_uv[i] = F(one.to_uv[i]);
  }
  KB_INLINE Boards(const KbCheckerboard* boards, U index) {
    static_assert(offsetof(KbCheckerboard, to_uv) == 8 && sizeof(KbCheckerboard) == 32);
    const Addresses records(boards, index);
    U words[2][4];
    for (uint32_t i = 0; i < 2; ++i) records.load(16 * i, words[i]);
    ref0 = words[0][0], ref1 = words[0][1];
    for (uint32_t i = 0; i < 6; ++i) to_uv[i] = as_floats(words[(i + 2) / 4][(i + 2) % 4]);
  }
};

/// Records by reference: mostly one, else gathered. Lanes that are not active have one of the others'. At least one is active.
template <class Records, class Record>
inline Records records_of(const std::vector<Record>& records, U ref, M active) {
  const WordArray refs(ref);
  const uint32_t one = refs[static_cast<uint32_t>(std::countr_zero(bits_of(active)))];
  if (!any(active & (ref != U(one)))) return Records(records[one & KB_REF_INDEX_MASK]);
  return Records(records.data(), select(active, ref, U(one)) & U(KB_REF_INDEX_MASK));
}
KB_INLINE Textures textures_of(const FlatScene& scene, U ref, M active) {
  return records_of<Textures>(scene.textures, ref, active);
}

/// One axis of a lookup: first texel, a whole number, and weight of the second.
struct AxisSample {
  F first, fraction;
};
KB_INLINE AxisSample select(M m, const AxisSample& yes, const AxisSample& no) {
  return {select(m, yes.first, no.first), select(m, yes.fraction, no.fraction)};
}

KB_INLINE TextureSample texture_sample(U texture, const AxisSample& x, const AxisSample& y) {
  return {texture, to_words(x.first) | shift_left<16>(to_words(y.first)), x.fraction, y.fraction};
}

// ---- one axis; x: coordinate in texels with texel i at x = i, or on [i, i + 1) where texels are not interpolated ----------

/// whole modulo period for integral numbers, in [0, period); exact below KB_LARGEST_COORDINATE.
KB_INLINE F wrap_period(D whole, F period) {
  return to_floats(whole - to_doubles(period) * floor(whole / to_doubles(period)));
}

KB_INLINE D usable(D x) {
  return zero_beyond(x, double{KB_LARGEST_COORDINATE});
}

/// NaN: 0
KB_INLINE AxisSample wrap_clamp(D x, F size) {
  const D inside = min(max(x, to_doubles(0.0)), to_doubles(size - F(1)));
  const D first = floor(inside);
  return {to_floats(first), to_floats(inside - first)};
}

KB_INLINE AxisSample wrap_repeat(D x, F size) {
  const D near = usable(x), first = floor(near);
  return {wrap_period(first, size), to_floats(near - first)};
}

/// The period is 2 * size: texels 0 .. size-1, then size-1 .. 0, which are stored in ascending order. Between size-1 and
/// size-1, and 0 and 0, there is one texel twice.
KB_INLINE AxisSample wrap_mirror(D x, F size) {
  const D near = usable(x), whole = floor(near);
  const F fraction = to_floats(near - whole), i = wrap_period(whole, F(2) * size);
  const F last = size - F(1), end = F(2) * size - F(1);
  const F turned = select((i == last) | (i == end), F(0), F(1) - fraction);
  return {select(i <= last, i, max(end - F(1) - i, F(0))), select(i < last, fraction, turned)};
}

KB_INLINE AxisSample wrap_linear(D x, F size, uint32_t wrap) {
  if (wrap == KB_WRAP_CLAMP) return wrap_clamp(x, size);
  return wrap == KB_WRAP_MIRROR ? wrap_mirror(x, size) : wrap_repeat(x, size);
}

KB_INLINE AxisSample wrap_nearest(D x, F size, uint32_t wrap) {
  if (wrap == KB_WRAP_CLAMP) return {wrap_clamp(floor(x), size).first, F(0)};
  const D whole = floor(usable(x));
  if (wrap == KB_WRAP_REPEAT) return {wrap_period(whole, size), F(0)};
  const F i = wrap_period(whole, F(2) * size);
  return {select(i < size, i, F(2) * size - F(1) - i), F(0)};
}

// ---- lookups -----------------------------------------------------------------------------------------

/// A row of uv' = M (u, v, 1).
KB_INLINE D row_of_uv(const F* m, V2 uv) {
  return to_doubles(m[0]) * to_doubles(uv.x) + to_doubles(m[1]) * to_doubles(uv.y) + to_doubles(m[2]);
}

/// By the way in which textures wrap, of which vectors mostly have one.
KB_INLINE TextureSample sample_bitmaps(const Textures& textures, U index, V2 uv, M active) {
  const F width = to_floats(textures.width), height = to_floats(textures.height);
  const D x = row_of_uv(textures.to_uv, uv) * to_doubles(width);
  const D y = row_of_uv(textures.to_uv + 3, uv) * to_doubles(height);
  AxisSample column{F(0), F(0)}, row = column;
  const auto take = [&](M lanes, const AxisSample& along_x, const AxisSample& along_y) KB_LAMBDA {
    column = select(lanes, along_x, column);
    row = select(lanes, along_y, row);
  };
  const D half = to_doubles(0.5);
  const M nearest = has_bits(textures.flags, KB_TEXTURE_NEAREST);
  for (const uint32_t wrap : {KB_WRAP_REPEAT, KB_WRAP_CLAMP, KB_WRAP_MIRROR}) {
    const M lanes = active & (textures.wrap == U(wrap)), linear = lanes & !nearest;
    if (any(linear)) take(linear, wrap_linear(x - half, width, wrap), wrap_linear(y - half, height, wrap));
    if (any(lanes & nearest))
      take(lanes & nearest, wrap_nearest(x, width, wrap), wrap_nearest(y, height, wrap));
  }
  return texture_sample(index, column, row);
}

/// KB_TEXTURE_TRIANGLES: triangle, and the weights of its second and third vertex.
KB_INLINE TextureSample sample_triangles(const Textures& textures, U index, U triangle, V2 weights) {
  const U x = triangle & U(KB_TRIANGLES_ACROSS - 1), y = shift_right<15>(triangle);
  static_assert(KB_TRIANGLES_ACROSS == 1u << 15);
  const M nearest = has_bits(textures.flags, KB_TEXTURE_NEAREST);
  const U xy = select(nearest, x | shift_left<16>(y), shift_left<1>(x) | shift_left<17>(y));
  const F rest = F(1) - weights.y, fx = min(max(weights.x / rest, F(0)), F(1));
  return {index, xy, select((rest > F(0)) & !nearest, fx, F(0)),
          select(nearest, F(0), min(max(weights.y, F(0)), F(1)))};
}

/// The row of ref0 where both coordinates are in the same half of their period, that of ref1 elsewhere (Mitsuba's order).
KB_INLINE U checkerboard_row(const Boards& boards, V2 uv) {
  const auto second_half = [&](const F* m) KB_LAMBDA {
    const D x = row_of_uv(m, uv);
    return to_floats(x - floor(x) - to_doubles(0.5)) > F(0);
  };
  const M second = second_half(boards.to_uv + 3);
  const M same = select(second_half(boards.to_uv), second, !second);
  return select(same, boards.ref0, boards.ref1) & U(KB_REF_INDEX_MASK);
}

/// The four texels of a lookup: (x0, y0) (x1, y0) (x0, y1) (x1, y1), from `first` on. A second texel
/// beyond the end has weight 0 unless the texture repeats.
struct Corners {
  U at[4];
};
KB_INLINE Corners corners_of(const Textures& textures, U first, U xy) {
  const auto second = [](U x, U size, M repeats) KB_LAMBDA {
    const U next = x + U(1u);
    return select(next == size, select(repeats, U(0u), x), next);
  };
  const M environment = has_bits(textures.flags, KB_TEXTURE_ENVMAP),
          repeat = textures.wrap == U(KB_WRAP_REPEAT);
  const U x0 = xy & U(0xffffu), y0 = shift_right<16>(xy);
  const U x1 = second(x0, textures.width, repeat | environment);
  const U y1 = second(y0, textures.height, repeat & !environment);
  const U row0 = first + y0 * textures.width, row1 = first + y1 * textures.width;
  return {{row0 + x0, row0 + x1, row1 + x0, row1 + x1}};
}

/// The bounds of a lookup's four texels.
struct CornerBounds {
  F at[4];

  KB_INLINE CornerBounds(const FlatScene& scene, const Textures& textures, U xy) {
    const Corners corners = corners_of(textures, textures.first_bound, xy);
    for (int k = 0; k < 4; ++k) at[k] = gather_from_large(scene.texel_bounds.data(), corners.at[k]);
  }
};

/// The largest bound of a lookup's four texels.
KB_INLINE F texel_bounds(const FlatScene& scene, U texture, U xy, M active) {
  const CornerBounds bound(scene, textures_of(scene, texture, active), select(active, xy, U(0u)));
  return max(max(bound.at[0], bound.at[1]), max(bound.at[2], bound.at[3]));
}

/// The bilinear value of a bitmap of numbers, which are the bounds of its texels.
KB_INLINE F bitmap_value(const FlatScene& scene, const Textures& textures, const TextureSample& s, M active) {
  const CornerBounds value(scene, textures, select(active, s.xy, U(0u)));
  const F top = (F(1) - s.fx) * value.at[0] + s.fx * value.at[1];
  const F bottom = (F(1) - s.fx) * value.at[2] + s.fx * value.at[3];
  return (F(1) - s.fy) * top + s.fy * bottom;
}

/// The environment map's sample for local coordinates u in [0,1) (periodic), v in [0,1] (rows align-corners).
KB_INLINE TextureSample sample_envmap_texture(const KbTexture& texture, uint32_t index, V2 uv) {
  const D x = to_doubles(uv.x) * to_doubles(double(texture.width)) - to_doubles(0.5);
  const D first = floor(x);  // -1 .. width - 1
  const F column = to_floats(first);
  const AxisSample along{select(column < F(0), F(static_cast<float>(texture.width - 1)), column),
                         to_floats(x - first)};
  return texture_sample(
      U(index), along,
      wrap_clamp(to_doubles(uv.y) * to_doubles(texture.height - 1.0), F(static_cast<float>(texture.height))));
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
