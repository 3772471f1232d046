// Texture addressing: which texels, with which weights. Evaluation per channel is deferred. texture-inl.hpp and
// texture_lookup-inl.hpp have it over lanes, this is one lane.
#pragma once

#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// Where on a surface a texture is looked up. Places that are no hits of meshes have texture coordinates alone.
struct TexturePoint {
  glm::vec2 uv;
  uint32_t triangle = 0;        // within the shape
  glm::vec2 barycentric{0, 0};  // weights of its second and third vertex

  TexturePoint(glm::vec2 coordinates) : uv(coordinates) {}
  TexturePoint(float u, float v) : uv(u, v) {}
  TexturePoint(glm::vec2 coordinates, uint32_t on_triangle, glm::vec2 weights)
      : uv(coordinates), triangle(on_triangle), barycentric(weights) {}
};

/// The bilinear (or nearest: fx = fy = 0) sample of a bitmap at uv; v = 0 is the first row, pixel centres at
/// (i + 0.5) / n, wrapped as the texture says. Exact at the borders of all wrap modes.
KbTextureSample sample_bitmap(const KbTexture& texture, uint32_t index, glm::vec2 uv);

/// A spectrum reference resolved at uv: the row of a named spectrum (checkerboards choose one),
/// or a texture sample.
struct ResolvedSpectrum {
  uint16_t row = 0;
  bool textured = false;
  KbTextureSample texture{};
};
ResolvedSpectrum resolve_spectrum(const FlatScene& scene, uint32_t ref, const TexturePoint& at);

/// The bilinear value of a flat (raw) bitmap, for opacities: sum of weights times texel scale.
float bitmap_value(const FlatScene& scene, const KbTextureSample& sample);

/// One of the surfaces that a blend blends, by the uniform number u, which is uniform again afterwards.
const KbSurface& blended_surface(const FlatScene& scene, const KbSurface& blend, const TexturePoint& at,
                                 float& u);

/// The surface that a ray finds where it hits surface `index`: itself, or what a blend chooses with u.
inline const KbSurface& chosen_surface(const FlatScene& scene, uint32_t index, const TexturePoint& at,
                                       float& u) {
  const KbSurface& surface = scene.surfaces[index];
  return surface.flags & KB_SURFACE_BLEND ? blended_surface(scene, surface, at, u) : surface;
}

/// A share between 0 and 1: a number, or where `ref` is not KB_NONE the value of a bitmap.
float share_at(const FlatScene& scene, uint32_t ref, float constant, const TexturePoint& at);

/// A mask's opacity; 1 for other surfaces.
inline float opacity_at(const FlatScene& scene, const KbSurface& surface, const TexturePoint& at) {
  return surface.opacity_ref == KB_NONE ? surface.opacity
                                        : share_at(scene, surface.opacity_ref, surface.opacity, at);
}

/// A material's number where `ref` is not KB_NONE: the value of a bitmap. `number` elsewhere.
inline float number_at(const FlatScene& scene, uint32_t ref, float number, const TexturePoint& at) {
  return ref == KB_NONE ? number : bitmap_value(scene, resolve_spectrum(scene, ref, at).texture);
}

}  // namespace kiloband::cpu
