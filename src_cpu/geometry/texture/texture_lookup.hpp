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

/// A spectrum reference resolved at uv: the row of a named spectrum (checkerboards choose one),
/// or a texture sample.
struct ResolvedSpectrum {
  uint16_t row = 0;
  bool textured = false;
  KbTextureSample texture{};
};
ResolvedSpectrum resolve_spectrum(const FlatScene& scene, uint32_t ref, const TexturePoint& at);

}  // namespace kiloband::cpu
