// BSDFs for one path at a time, in glm's types: the lanes' sources for one lane (src_cpu/bsdf/bsdf-inl.hpp), which renders
// have no use for but tests ask one question at a time. Conventions and units: src_cpu/bsdf/common-inl.hpp.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband::test {

/// The weights of one direction pair, for KbVertexKind eval_kind(material).
struct BsdfValue {
  /// f |cos theta_o| without spectral factors [1/sr]; see KB_KIND_*. KB_KIND_TINTED: w1 < 0 where sqrt(S_a) is the factor
  float w0 = 0, w1 = 0;
  float pdf = 0;        // solid angle [1/sr], of sample_bsdf choosing wo (0 for delta lobes)
  bool lobe_b = false;  // KB_KIND_SCALED: the factor is S_b instead of S_a (dielectric transmittance)
};

/// A vertex has one kind: for materials with a non-delta lobe `kind` equals eval_kind(material), so that
/// light and BSDF samples can share a vertex. Only rough dielectrics may need S_a for one and S_b for the
/// other: w0 * S_a is then KB_KIND_TWO_TERM with (w0, 0), w0 * S_b with (0, w0).
struct BsdfSample {
  glm::vec3 wo{0};
  float w0 = 0, w1 = 0;  // f |cos theta_o| / pdf without spectral factors (delta lobes: weight / probability)
  /// Solid angle [1/sr], or the discrete probability of a delta lobe; 0: no sample, the path ends.
  float pdf = 0;
  float eta = 1;    // transmission: ratio of refractive indices, transmitted over incident side; else 1
  float bound = 0;  // upper bound of this sample's throughput factor over all channels, times eta^2: without
                    // the radiance scaling, as roulette wants it
  bool delta = false;
  bool transmission = false;
  uint8_t kind = KB_KIND_SCALED;  // how w0, w1 are to be evaluated
  bool lobe_b = false;         // KB_KIND_SCALED: the factor is S_b instead of S_a (dielectric transmittance)
  bool needs_channel = false;  // dispersive transmission with probability pdf: the caller chooses a channel
                               // and calls transmit_dispersive; wo, w0 and bound are not set
};

/// The wavelength that a dispersive material is evaluated for after degradation. Before it, reflection by a
/// smooth dielectric is for all channels (KB_KIND_DISPERSIVE) while transmission needs a channel
/// to be chosen by the caller.
struct DispersionState {
  float eta = 0;  // interior over exterior index at the chosen wavelength; 0: not degraded
};

/// A material with what is kept beside its record.
struct MaterialContext {
  const KbMaterial* material = nullptr;
  const float* table = nullptr;  // its tables (shared/material_tables.h), if it has any
  DispersionState dispersion;    // for KB_MATERIAL_DISPERSIVE, else unused
  /// For KB_MATERIAL_COMPENSATED: its table (shared/thermal.h), behind `table` if it has that; else unused.
  const float* compensation = nullptr;
};

/// E(wi) of a compensated material: the albedo of its single-scattering lobe. Source: shared/thermal.h.
float lobe_albedo(const MaterialContext& context, glm::vec3 wi);

/// Value and density for wi -> wo; zero for delta materials and for directions
/// that the material does not scatter to.
/// throws std::logic_error  a rough plastic without table, a rough dispersive dielectric that is not degraded
BsdfValue eval_bsdf(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo);

/// Chooses a direction; the weights are f |cos theta_o| / pdf of the whole material for non-delta lobes, and
/// of the chosen lobe for delta ones. u_lobe and u uniform in [0,1).
/// throws as eval_bsdf
BsdfSample sample_bsdf(const MaterialContext& context, glm::vec3 wi, float u_lobe, glm::vec2 u);

/// Second half of a sample with needs_channel: refracts wi for the chosen channel.
/// eta_channel  interior over exterior index at the channel's wavelength
/// probability  of getting here: the sample's pdf times the probability of the channel
/// returns pdf == 0 on total internal reflection (this channel is carried by the reflected sample alone)
BsdfSample transmit_dispersive(const KbMaterial& material, glm::vec3 wi, float eta_channel,
                               float probability);

/// A pair of directions at a rough dispersive boundary, for every channel at once. For reflection the vertex
/// is KB_KIND_DISPERSIVE with w0 = weight, w1 = cosine; for transmission KB_KIND_ROUGH_TRANSMISSION with
/// w0 = weight and the directions (shared/rough_transmission.h).
struct BoundaryPair {
  float weight = 0;  // f |cos theta_o| [1/sr] without Fresnel's reflectance; or without the factor T; 0: none
  float cosine = 0;  // reflection: of wi and the half vector, negative from inside
  bool transmission = false;
};
BoundaryPair rough_boundary_pair(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo);

/// The KbVertexKind of eval_bsdf's weights for this material.
uint8_t eval_kind(const KbMaterial& material);

/// True if the material has a non-delta lobe, so that next-event estimation makes sense.
bool has_smooth_lobe(const KbMaterial& material);

}  // namespace kiloband::test
