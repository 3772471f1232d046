// Wavelength-independent part of the BSDFs on the CPU: what sampling, densities and saved vertices need.
//
// A BSDF value times |cos theta_o| is split into a part that does not depend on wavelength and the spectral factors that
// deferred evaluation applies (KbVertexKind in shared/records.h). Directions are unit vectors in the local shading frame
// (z = normal), both pointing away from the surface; wi is where the path comes from, wo where it goes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband {

/// The weights of one direction pair, for KbVertexKind `kind` of the material.
struct BsdfValue {
  float w0 = 0, w1 = 0;  // f |cos theta_o| without spectral factors; see KB_KIND_*
  float pdf = 0;         // solid angle [1/sr], of sample_bsdf choosing wo (0 for delta lobes)
};

struct BsdfSample {
  glm::vec3 wo{0};
  float w0 = 0, w1 = 0;    // f |cos theta_o| / pdf without spectral factors (delta lobes: weight / probability)
  float pdf = 0;           // solid angle, or the discrete probability of a delta lobe; 0: no sample, the path ends
  float eta = 1;           // transmission: ratio of refractive indices, transmitted over incident side; else 1
  float bound = 0;         // upper bound of the throughput factor over all channels, radiance scaling by eta included
  bool delta = false;
  bool transmission = false;
  uint8_t kind = KB_KIND_SCALED;  // how w0, w1 are to be evaluated
  bool lobe_b = false;     // KB_KIND_SCALED: the factor is S_b instead of S_a (dielectric transmittance)
};

/// The wavelength that a dispersive material is evaluated for after degradation; before it, use_channel is false and
/// reflection is for all channels (KB_KIND_DISPERSIVE) while transmission needs a channel to be chosen by the caller.
struct DispersionState {
  float eta = 0;  // interior over exterior index at the chosen wavelength; 0: not degraded
};

/// Value and density for wi -> wo; zero for delta materials and for directions that the material does not scatter to.
BsdfValue eval_bsdf(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo, DispersionState dispersion = {});
/// The kind of eval_bsdf's weights for this material.
uint8_t eval_kind(const KbMaterial& material);
/// u_lobe and u uniform in [0,1)
BsdfSample sample_bsdf(const KbMaterial& material, glm::vec3 wi, float u_lobe, glm::vec2 u, DispersionState dispersion = {});
/// True if the material has a non-delta lobe, so that next-event estimation makes sense.
bool has_smooth_lobe(const KbMaterial& material);

}  // namespace kiloband
