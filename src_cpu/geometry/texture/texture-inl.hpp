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
#include "src_cpu/geometry/texture/texture_lookup.hpp"

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

/// The places lane by lane.
class TexturePoints {
 public:
  explicit TexturePoints(const TexturePlace& at)
      : u_(at.uv.x), v_(at.uv.y), b1_(at.barycentric.x), b2_(at.barycentric.y), triangle_(at.triangle) {}
  TexturePoint operator[](uint32_t lane) const {
    return {{u_[lane], v_[lane]}, triangle_[lane], {b1_[lane], b2_[lane]}};
  }

 private:
  FloatArray u_, v_, b1_, b2_;
  WordArray triangle_;
};

KB_INLINE Resolved resolved_row(U row) {
  return {row, no_lanes(), {U(0u), U(0u), F(0), F(0)}};
}

KB_INLINE Resolved select(M m, const Resolved& yes, const Resolved& no) {
  return {select(m, yes.row, no.row),
          select(m, yes.textured, no.textured),
          {select(m, yes.sample.texture, no.sample.texture), select(m, yes.sample.xy, no.sample.xy),
           select(m, yes.sample.fx, no.sample.fx), select(m, yes.sample.fy, no.sample.fy)}};
}

/// Bitmaps and checkerboards.
inline Resolved resolve_textures(const FlatScene& scene, U ref, const TexturePlace& at, U row, M active) {
  Resolved resolved = resolved_row(row);
  each_distinct(active, ref, [&](uint32_t one, M lanes) KB_LAMBDA {
    const uint32_t index = one & KB_REF_INDEX_MASK;
    if ((one & KB_REF_KIND_MASK) == KB_REF_CHECKERBOARD) {
      resolved.row = select(lanes, checkerboard_row(scene.checkerboards[index], at.uv), resolved.row);
    } else {
      const KbTexture& texture = scene.textures[index];
      const bool by_triangle = (texture.flags & KB_TEXTURE_TRIANGLES) != 0;
      const Resolved lookup{U(0u), lanes,
                            by_triangle ? sample_triangles(texture, index, at.triangle, at.barycentric)
                                        : sample_bitmap(texture, index, at.uv)};
      resolved = select(lanes, lookup, resolved);
    }
  });
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
  each_distinct(local & spectrum.textured, spectrum.sample.texture, [&](uint32_t texture, M lanes) KB_LAMBDA {
    const U xy = select(lanes, spectrum.sample.xy, U(0u));
    local_bound = select(lanes, texel_bounds(scene, texture, xy), local_bound);
  });
  each_distinct(local & !spectrum.textured, spectrum.row, [&](uint32_t row, M lanes) KB_LAMBDA {
    local_bound = select(lanes, F(scene.spectra[row].bound), local_bound);
  });
  return local_bound;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
