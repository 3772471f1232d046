// References to spectra, resolved at texture coordinates.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_TEXTURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_TEXTURE_INL
#undef KILOBAND_TEXTURE_INL
#else
#define KILOBAND_TEXTURE_INL
#endif

#include "src_cpu/geometry/texture/texture_lookup-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// A row of the spectra, or where `textured` a lookup in a texture.
struct Resolved {
  U row;
  M textured;
  TextureSample sample;
};

/// TexturePoint in lanes.
struct TexturePlace {
  V2 uv;
  U triangle;
  V2 barycentric;
};
/// A place that is no hit of a mesh.
KB_INLINE TexturePlace place_at(V2 uv) {
  return {uv, U(0u), {F(0), F(0)}};
}

KB_INLINE Resolved resolved_row(U row) {
  return {row, no_lanes(), {U(0u), U(0u), F(0), F(0)}};
}

KB_INLINE TextureSample select(M m, const TextureSample& yes, const TextureSample& no) {
  return {select(m, yes.texture, no.texture), select(m, yes.xy, no.xy), select(m, yes.fx, no.fx),
          select(m, yes.fy, no.fy)};
}
KB_INLINE Resolved select(M m, const Resolved& yes, const Resolved& no) {
  return {select(m, yes.row, no.row), select(m, yes.textured, no.textured), select(m, yes.sample, no.sample)};
}

/// Lookups in bitmaps.
KB_INLINE TextureSample sample_textures(const FlatScene& scene, const Textures& textures, U index,
                                        const TexturePlace& at, M active) {
  const TextureSample sample = sample_bitmaps(textures, index, at.uv, active);
  if (!scene.features.mesh_attribute) return sample;
  const M by_triangle = has_bits(textures.flags, KB_TEXTURE_TRIANGLES);
  return select(by_triangle, sample_triangles(textures, index, at.triangle, at.barycentric), sample);
}

/// Bitmaps and checkerboards.
inline Resolved resolve_textures(const FlatScene& scene, U ref, const TexturePlace& at, U row, M active) {
  Resolved resolved = resolved_row(row);
  const M board = active & ((ref & U(KB_REF_KIND_MASK)) == U(KB_REF_CHECKERBOARD));
  if (any(board)) {
    const Boards boards = records_of<Boards>(scene.checkerboards, ref, board);
    resolved.row = select(board, checkerboard_row(boards, at.uv), row);
  }
  const M bitmap = active & !board;
  if (any(bitmap)) {
    const Textures textures = textures_of(scene, ref, bitmap);
    const U index = ref & U(KB_REF_INDEX_MASK);
    resolved = select(bitmap, {U(0u), bitmap, sample_textures(scene, textures, index, at, bitmap)}, resolved);
  }
  return resolved;
}

/// Spectra by reference. Lanes that are not active get row 0.
KB_INLINE Resolved resolve(const FlatScene& scene, U ref, const TexturePlace& at, M active) {
  const U row = select(active, ref & U(KB_REF_INDEX_MASK), U(0u));
  const M other = active & has_bits(ref, KB_REF_KIND_MASK);
  if (!any(other)) return resolved_row(row);
  return resolve_textures(scene, ref, at, row, other);
}

/// Upper bounds of resolved spectra at this very point: the bounds of a whole image would keep paths alive for ever
/// where one texel is white.
/// bound  of the reference, which named spectra have everywhere
KB_INLINE F bound_at(const FlatScene& scene, U ref, const Resolved& spectrum, F bound, M active) {
  const M local = active & has_bits(ref, KB_REF_KIND_MASK);
  if (!any(local)) return bound;
  F local_bound = bound;
  if (const M textured = local & spectrum.textured; any(textured)) {
    const TextureSample& sample = spectrum.sample;
    local_bound = select(textured, texel_bounds(scene, sample.texture, sample.xy, textured), bound);
  }
  each_distinct(local & !spectrum.textured, spectrum.row, [&](uint32_t row, M lanes) KB_LAMBDA {
    local_bound = select(lanes, F(scene.spectra[row].bound), local_bound);
  });
  return local_bound;
}

// ---- numbers -----------------------------------------------------------------------------------------

/// Numbers by reference: the values of bitmaps; `number` of lanes without (KB_NONE) and of those that are not active.
inline F number_at(const FlatScene& scene, U ref, const TexturePlace& at, F number, M active) {
  const M mapped = active & (ref != U(KB_NONE));
  if (!any(mapped)) return number;
  const Textures textures = textures_of(scene, ref, mapped);
  const TextureSample sample = sample_textures(scene, textures, ref & U(KB_REF_INDEX_MASK), at, mapped);
  return select(mapped, bitmap_value(scene, textures, sample, mapped), number);
}

/// The same of numbers that bitmaps give from 0 to 1.
KB_INLINE F share_at(const FlatScene& scene, U ref, const TexturePlace& at, F share, M active) {
  const F value = number_at(scene, ref, at, share, active);
  return select(ref == U(KB_NONE), share, min(max(value, F(0)), F(1)));
}

/// The surfaces that rays find where they hit these: themselves, or what a blend chooses with u, which is uniform again
/// afterwards.
inline U chosen_surface(const FlatScene& scene, U surface, const TexturePlace& at, F& u, M active) {
  const KbSurface* surfaces = scene.surfaces.data();
  const auto blends = [&] KB_LAMBDA {
    return active & has_bits(KB_GATHER_WORD(surfaces, KbSurface, flags, surface), KB_SURFACE_BLEND);
  };
  for (M left = blends(); any(left); left = blends()) {
    const F weight = share_at(scene, KB_GATHER_WORD(surfaces, KbSurface, weight_ref, surface), at,
                              KB_GATHER_FLOAT(surfaces, KbSurface, weight, surface), left);
    const M second = u < weight;
    const F again = select(second, u / weight, (u - weight) / (F(1) - weight));
    u = select(left, min(again, F(KB_ONE_MINUS_EPSILON)), u);
    const U one = select(second, KB_GATHER_WORD(surfaces, KbSurface, second, surface),
                         KB_GATHER_WORD(surfaces, KbSurface, first, surface));
    surface = select(left, one, surface);
  }
  return surface;
}

/// A mask's opacity; 1 of other surfaces.
KB_INLINE F opacity_at(const FlatScene& scene, U surface, const TexturePlace& at, M active) {
  const KbSurface* surfaces = scene.surfaces.data();
  return share_at(scene, KB_GATHER_WORD(surfaces, KbSurface, opacity_ref, surface), at,
                  KB_GATHER_FLOAT(surfaces, KbSurface, opacity, surface), active);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
