// Texture lookups one at a time: texture-inl.hpp for one lane, and what lanes do not need.
#include "src_cpu/geometry/texture/texture_lookup.hpp"

#include <algorithm>

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/geometry/texture/texture-inl.hpp"

namespace kiloband::cpu {
namespace {

KbTextureSample sample_of(const one_lane::TextureSample& s) {
  return {s.texture.v, s.xy.v, s.fx.v, s.fy.v};
}

}  // namespace

KbTextureSample sample_bitmap(const KbTexture& texture, uint32_t index, glm::vec2 uv) {
  return sample_of(one_lane::sample_bitmap(texture, index, to_lane(uv)));
}

ResolvedSpectrum resolve_spectrum(const FlatScene& scene, uint32_t ref, const TexturePoint& at) {
  const one_lane::TexturePlace place{to_lane(at.uv), {at.triangle}, to_lane(at.barycentric)};
  const one_lane::Resolved one = one_lane::resolve(scene, ref, place, {true});
  return {static_cast<uint16_t>(one.row.v), one.textured.v, sample_of(one.sample)};
}

float bitmap_value(const FlatScene& scene, const KbTextureSample& sample) {
  const KbTexture& texture = scene.textures[sample.texture];
  const one_lane::Corners c = one_lane::corners_of(texture, texture.first_texel, sample.xy);
  const auto value = [&](int corner) { return scene.texels[c.at[corner].v].w; };
  const float top = (1 - sample.fx) * value(0) + sample.fx * value(1);
  const float bottom = (1 - sample.fx) * value(2) + sample.fx * value(3);
  return (1 - sample.fy) * top + sample.fy * bottom;
}

float share_at(const FlatScene& scene, uint32_t ref, float constant, const TexturePoint& at) {
  if (ref == KB_NONE) return constant;
  const ResolvedSpectrum value = resolve_spectrum(scene, ref, at);
  return std::clamp(bitmap_value(scene, value.texture), 0.0f, 1.0f);
}

const KbSurface& blended_surface(const FlatScene& scene, const KbSurface& blend, const TexturePoint& at,
                                 float& u) {
  const KbSurface* surface = &blend;
  while (surface->flags & KB_SURFACE_BLEND) {
    const float weight = share_at(scene, surface->weight_ref, surface->weight, at);
    const bool second = u < weight;
    u = std::min(second ? u / weight : (u - weight) / (1 - weight), KB_ONE_MINUS_EPSILON);
    surface = &scene.surfaces[second ? surface->second : surface->first];
  }
  return *surface;
}

}  // namespace kiloband::cpu
