// Texture lookups one at a time: texture-inl.hpp for one lane, and what lanes do not need.
#include "src_cpu/geometry/texture/texture_lookup.hpp"

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/geometry/texture/texture-inl.hpp"

namespace kiloband::cpu {
namespace {

KbTextureSample sample_of(const one_lane::TextureSample& s) {
  return {s.texture.v, s.xy.v, s.fx.v, s.fy.v};
}

}  // namespace

ResolvedSpectrum resolve_spectrum(const FlatScene& scene, uint32_t ref, const TexturePoint& at) {
  const one_lane::TexturePlace place{to_lane(at.uv), {at.triangle}, to_lane(at.barycentric)};
  const one_lane::Resolved one = one_lane::resolve(scene, ref, place, {true});
  return {static_cast<uint16_t>(one.row.v), one.textured.v, sample_of(one.sample)};
}

}  // namespace kiloband::cpu
