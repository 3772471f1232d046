// What all BSDFs have in common: a material in each lane, a value, a sample. They are the wavelength-independent part: what
// sampling, densities and saved vertices need.
//
// A BSDF value times |cos theta_o| is split into a part that does not depend on wavelength and the spectral
// factors that deferred evaluation applies (KbVertexKind in shared/path_vertex.h). Directions are unit vectors in
// the local shading frame (z = normal), both pointing away from the surface; wi is where the path comes from,
// wo where it goes.
//
// Conventions, which are Mitsuba 3's: reflecting materials are black from behind (cos_i <= 0 or cos_o <= 0),
// transmitted radiance is scaled by 1 / eta^2 (radiance transport), cosines are those of the shading frame.
// Roughness below 1e-4 is 1e-4. Differences: Beckmann's masking is exact (Mitsuba's rational fit is off by up
// to 0.35 %), plastic lobes are chosen with 10 % uniform mixed in, and a rough dielectric whose lobe float
// directions cannot resolve (min(alpha) * |eta - 1| < 3e-6) acts as a smooth one.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_COMMON_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_COMMON_INL
#undef KILOBAND_BSDF_COMMON_INL
#else
#define KILOBAND_BSDF_COMMON_INL
#endif

#include "shared/material_tables.h"
#include "shared/principled.h"
#include "shared/records.h"
#include "src_cpu/lanes/lane_access-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// The numbers of principled materials: KbPrincipledNumber.
struct Principled {
  F number[KB_PRINCIPLED_NUMBERS];
};

/// What the BSDFs read of a KbMaterial, which is described there.
struct Material {
  U type, flags, ref_a, ref_b;
  F alpha_u, alpha_v, eta, specular_weight, escape, bound_a, bound_b;
  U table;         // where its tables begin in `tables`, or KB_NONE
  U compensation;  // where its table of energy compensation begins there, or KB_NONE
  /// Dispersive: interior over exterior index at the wavelength chosen by degradation; 0: not degraded. Before it, reflection by a
  /// smooth dielectric is for all channels (KB_KIND_DISPERSIVE) while transmission needs a channel to be chosen by the caller.
  F channel_eta;
  const float* tables;           // of the scene; for lanes that have a table at all
  const Principled* principled;  // of lanes that have a principled material; null: none has
};

/// The same material in every lane, without its tables.
KB_INLINE Material one_material(const KbMaterial& m) {
  return {m.type,   m.flags,   m.ref_a,   m.ref_b,    m.alpha_u,  m.alpha_v, m.eta,   m.specular_weight,
          m.escape, m.bound_a, m.bound_b, U(KB_NONE), U(KB_NONE), F(0),      nullptr, nullptr};
}

/// The weights of one direction pair, for KbVertexKind eval_kind(material).
struct BsdfValue {
  /// f |cos theta_o| without spectral factors [1/sr]; see KB_KIND_*. KB_KIND_TINTED: w1 < 0 where sqrt(S_a) is the factor
  F w0, w1;
  F pdf;     // solid angle [1/sr], of sample_bsdf choosing wo (0 for delta lobes)
  M lobe_b;  // KB_KIND_SCALED: the factor is S_b instead of S_a (dielectric transmittance)
};

/// A vertex has one kind: for materials with a non-delta lobe `kind` equals eval_kind(material), so that
/// light and BSDF samples can share a vertex. Only rough dielectrics may need S_a for one and S_b for the
/// other: w0 * S_a is then KB_KIND_TWO_TERM with (w0, 0), w0 * S_b with (0, w0).
struct BsdfSample {
  V3 wo;
  F w0, w1;  // f |cos theta_o| / pdf without spectral factors (delta lobes: weight / probability)
  F pdf;     // solid angle [1/sr], or the discrete probability of a delta lobe; 0: no sample, the path ends
  F eta;     // transmission: ratio of refractive indices, transmitted over incident side; else 1
  /// Upper bound of this sample's throughput factor over all channels, times eta^2: without the radiance scaling, as roulette wants it.
  F bound;
  M delta, transmission;
  M lobe_b;  // KB_KIND_SCALED: the factor is S_b instead of S_a (dielectric transmittance)
  /// Dispersive transmission with probability pdf: the caller chooses a channel and calls transmit_dispersive; wo, w0 and bound are not
  /// set.
  M needs_channel;
  U kind;  // how w0, w1 are to be evaluated
};

KB_INLINE BsdfValue no_value() {
  return {F(0), F(0), F(0), no_lanes()};
}

KB_INLINE BsdfSample no_sample() {
  const M none = no_lanes();
  return {{F(0), F(0), F(0)},         F(0), F(0), F(0), F(1), F(0), none, none, none, none,
          U(uint32_t{KB_KIND_SCALED})};
}

KB_INLINE void put(BsdfValue& to, M lanes, const BsdfValue& from) {
  to.w0 = select(lanes, from.w0, to.w0);
  to.w1 = select(lanes, from.w1, to.w1);
  to.pdf = select(lanes, from.pdf, to.pdf);
  to.lobe_b = select(lanes, from.lobe_b, to.lobe_b);
}

KB_INLINE void put(BsdfSample& to, M lanes, const BsdfSample& from) {
  to.wo = select(lanes, from.wo, to.wo);
  to.w0 = select(lanes, from.w0, to.w0);
  to.w1 = select(lanes, from.w1, to.w1);
  to.pdf = select(lanes, from.pdf, to.pdf);
  to.eta = select(lanes, from.eta, to.eta);
  to.bound = select(lanes, from.bound, to.bound);
  to.delta = select(lanes, from.delta, to.delta);
  to.transmission = select(lanes, from.transmission, to.transmission);
  to.lobe_b = select(lanes, from.lobe_b, to.lobe_b);
  to.needs_channel = select(lanes, from.needs_channel, to.needs_channel);
  to.kind = select(lanes, from.kind, to.kind);
}

KB_INLINE M is_type(U type, KbMaterialType wanted) {
  return type == U(static_cast<uint32_t>(wanted));
}

/// Where the energy compensation of these materials begins, behind their other tables; KB_NONE: nowhere.
KB_INLINE U compensation_offset(U type, U flags, U table) {
  const M metal = is_type(type, KB_MATERIAL_CONDUCTOR) | is_type(type, KB_MATERIAL_ROUGH_CONDUCTOR);
  const M bounded = metal & !has_bits(flags, KB_MATERIAL_PERFECT_MIRROR);
  U before = select(bounded, U(kb_floats_before_compensation(KB_MATERIAL_ROUGH_CONDUCTOR, 0)), U(0u));
  before = select(is_type(type, KB_MATERIAL_ROUGH_PLASTIC),
                  U(kb_floats_before_compensation(KB_MATERIAL_ROUGH_PLASTIC, 0)), before);
  return select(has_bits(flags, KB_MATERIAL_COMPENSATED), table + before, U(KB_NONE));
}

/// Material `index` of each lane, not degraded. index: that of a record in every lane, in use or not
KB_INLINE Material gather_material(const KbMaterial* materials, const float* tables, U index) {
  static_assert(offsetof(KbMaterial, alpha_u) == 28 && offsetof(KbMaterial, table) == 60);
  const Addresses records(materials, index);
  U words[4];
  Material m;
  records.load(0, words);
  m.type = words[0];
  m.flags = words[1];
  m.ref_a = words[2];
  m.ref_b = words[3];
  records.load(28, words);
  m.alpha_u = as_floats(words[0]);
  m.alpha_v = as_floats(words[1]);
  m.eta = as_floats(words[2]);
  records.load(44, words);
  m.escape = as_floats(words[0]);
  m.specular_weight = as_floats(words[1]);
  m.bound_a = as_floats(words[2]);
  m.bound_b = as_floats(words[3]);
  m.table = gather_word<KbMaterial>(materials, offsetof(KbMaterial, table), index);
  m.compensation = compensation_offset(m.type, m.flags, m.table);
  m.channel_eta = F(0);
  m.tables = tables;
  m.principled = nullptr;
  return m;
}

/// The KbVertexKind of eval_bsdf's weights.
KB_INLINE U eval_kind(U type, U flags) {
  const M metal = is_type(type, KB_MATERIAL_CONDUCTOR) | is_type(type, KB_MATERIAL_ROUGH_CONDUCTOR);
  const M plastic = is_type(type, KB_MATERIAL_PLASTIC) | is_type(type, KB_MATERIAL_ROUGH_PLASTIC);
  U kind(uint32_t{KB_KIND_SCALED});
  kind = select(metal & !has_bits(flags, KB_MATERIAL_PERFECT_MIRROR), U(uint32_t{KB_KIND_CONDUCTOR}), kind);
  kind = select(is_type(type, KB_MATERIAL_PRINCIPLED), U(uint32_t{KB_KIND_TINTED}), kind);
  return select(plastic,
                select(has_bits(flags, KB_MATERIAL_NONLINEAR), U(uint32_t{KB_KIND_NONLINEAR}),
                       U(uint32_t{KB_KIND_TWO_TERM})),
                kind);
}

/// Has the material a non-delta lobe, so that next-event estimation makes sense?
KB_INLINE M has_smooth_lobe(U type) {
  return !(is_type(type, KB_MATERIAL_CONDUCTOR) | is_type(type, KB_MATERIAL_DIELECTRIC));
}

/// Dispersive, and no channel is chosen yet.
KB_INLINE M not_degraded(const Material& m) {
  return has_bits(m.flags, KB_MATERIAL_DISPERSIVE) & !(m.channel_eta > F(0));
}

/// Interior over exterior index of a dielectric.
KB_INLINE F index_ratio(const Material& m) {
  const M chosen = has_bits(m.flags, KB_MATERIAL_DISPERSIVE) & (m.channel_eta > F(0));
  return select(chosen, m.channel_eta, m.eta);
}

KB_INLINE V3 mirror(V3 w) {
  return {-w.x, -w.y, w.z};
}

KB_INLINE V3 flip(V3 w) {
  return {w.x, w.y, -w.z};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
