// References to spectra, resolved at texture coordinates.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_TEXTURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_TEXTURE_INL
#undef KILOBAND_TEXTURE_INL
#else
#define KILOBAND_TEXTURE_INL
#endif

#include "src_cpu/geometry/texture_lookup.hpp"
#include "src_cpu/lanes/lane_access-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// KbTextureSample in lanes.
struct TextureSample {
  U texture, xy;
  F fx, fy;
};

/// A row of the spectra, or where `textured` a lookup in a texture.
struct Resolved {
  U row;
  M textured;
  TextureSample sample;
};

KB_INLINE Resolved resolved_row(U row) {
  return {row, no_lanes(), {U(0u), U(0u), F(0), F(0)}};
}

/// Bitmaps and checkerboards, whose coordinates are in double: one lane after another.
inline Resolved resolve_textures(const FlatScene& scene, U ref, V2 uv, U row, M active) {
  WordArray rows(row), texture(U(0u)), xy(U(0u)), textured(U(0u));
  FloatArray fx(F(0)), fy(F(0));
  const WordArray refs(ref);
  const FloatArray u(uv.x), v(uv.y);
  each_lane(active, [&](uint32_t i) KB_LAMBDA {
    const ResolvedSpectrum one = resolve_spectrum(scene, refs[i], {u[i], v[i]});
    rows[i] = one.row;
    if (!one.textured) return;
    textured[i] = 1;
    texture[i] = one.texture.texture;
    xy[i] = one.texture.xy;
    fx[i] = one.texture.fx;
    fy[i] = one.texture.fy;
  });
  return {rows, has_bits(textured, 1u), {texture, xy, fx, fy}};
}

/// Spectra by reference. Lanes that are not active get row 0.
KB_INLINE Resolved resolve(const FlatScene& scene, U ref, V2 uv, M active) {
  const U row = select(active, ref & U(KB_REF_INDEX_MASK), U(0u));
  const M other = active & has_bits(ref, KB_REF_KIND_MASK);
  if (!any(other)) return resolved_row(row);
  return resolve_textures(scene, ref, uv, row, other);
}

KB_INLINE Resolved select(M m, const Resolved& yes, const Resolved& no) {
  return {select(m, yes.row, no.row),
          select(m, yes.textured, no.textured),
          {select(m, yes.sample.texture, no.sample.texture), select(m, yes.sample.xy, no.sample.xy),
           select(m, yes.sample.fx, no.sample.fx), select(m, yes.sample.fy, no.sample.fy)}};
}

/// Upper bounds of resolved spectra at this very point: the bounds of a whole image would keep paths alive for ever
/// where one texel is white.
/// bound  of the reference, which named spectra have everywhere
KB_INLINE F bound_at(const FlatScene& scene, U ref, const Resolved& spectrum, F bound, M active) {
  const M local = active & has_bits(ref, KB_REF_KIND_MASK);
  if (!any(local)) return bound;
  FloatArray bounds(bound);
  const WordArray row(spectrum.row), texture(spectrum.sample.texture), xy(spectrum.sample.xy);
  const uint32_t textured = bits_of(spectrum.textured);
  each_lane(local, [&](uint32_t i) KB_LAMBDA {
    bounds[i] = textured >> i & 1 ? texel_bound(scene, texture[i], xy[i]) : scene.spectra[row[i]].bound;
  });
  return bounds;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
