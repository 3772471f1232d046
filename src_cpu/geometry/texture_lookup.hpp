// Texture addressing: which texels, with which weights. Evaluation per channel is deferred.
#pragma once

#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// The bilinear (or nearest: fx = fy = 0) sample of a bitmap at uv; v = 0 is the first row, pixel centres at
/// (i + 0.5) / n, wrapped as the texture says. Exact at the borders of all wrap modes.
KbTextureSample sample_bitmap(const KbTexture& texture, uint32_t index, glm::vec2 uv);
/// The environment map's sample for local coordinates u in [0,1) (periodic), v in [0,1] (rows align-corners).
KbTextureSample sample_envmap_texture(const KbTexture& texture, uint32_t index, glm::vec2 uv);

/// A spectrum reference resolved at uv: the row of a named spectrum (checkerboards choose one),
/// or a texture sample.
struct ResolvedSpectrum {
  uint16_t row = 0;
  bool textured = false;
  KbTextureSample texture{};
};
ResolvedSpectrum resolve_spectrum(const FlatScene& scene, uint32_t ref, glm::vec2 uv);

/// The bilinear value of a flat (raw) bitmap, for opacities: sum of weights times texel scale.
float bitmap_value(const FlatScene& scene, const KbTextureSample& sample);

/// The surface that a ray finds where it hits surface `index`: of a blend one of those blended, by the uniform number
/// u, which is uniform again afterwards.
const KbSurface& chosen_surface(const FlatScene& scene, uint32_t index, glm::vec2 uv, float& u);

/// A mask's opacity; 1 for other surfaces.
float opacity_at(const FlatScene& scene, const KbSurface& surface, glm::vec2 uv);

/// Upper bound of a resolved spectrum over guide bands and rendered channels
/// (of a lookup: of its four texels).
float spectrum_bound(const FlatScene& scene, const ResolvedSpectrum& spectrum);

}  // namespace kiloband::cpu
