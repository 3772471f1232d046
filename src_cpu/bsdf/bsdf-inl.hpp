// Chooses each lane's material: eval_bsdf() and sample_bsdf().
//
// A material's code runs where a lane has it, so that a wave of one material pays for one; for one lane that is a
// branch. Lanes outside `active`, and those without a value or sample, get pdf and weights of 0. Without a value, too,
// is a rough dispersive dielectric that is not degraded; a rough plastic has to have its table.
//
// The heroes of spectral MIS are asked for one path at a time, each in a lane (bsdf/spectral_mis-inl.hpp): few paths are at a
// rough dispersive boundary together, and each evaluates it for up to 8 indices.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_INL
#undef KILOBAND_BSDF_INL
#else
#define KILOBAND_BSDF_INL
#endif

#include "src_cpu/bsdf/compensation-inl.hpp"
#include "src_cpu/bsdf/conductor-inl.hpp"
#include "src_cpu/bsdf/dielectric-inl.hpp"
#include "src_cpu/bsdf/diffuse-inl.hpp"
#include "src_cpu/bsdf/plastic-inl.hpp"
#include "src_cpu/bsdf/principled-inl.hpp"
#include "src_cpu/bsdf/principled_thin-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// Models are for wi above: distributions of normals are symmetric.
KB_INLINE void eval_dielectric_side(const Material& m, V3 wi, V3 wo, M active, BsdfValue& value) {
  const M below = wi.z < F(0);
  const F eta = select(below, F(1) / index_ratio(m), index_ratio(m));
  eval_rough_dielectric(m, select(below, flip(wi), wi), select(below, flip(wo), wo), eta, active, value);
}

KB_INLINE void sample_dielectric_side(const Material& m, V3 wi, F u_lobe, V2 u, M active,
                                      BsdfSample& sample) {
  const M rough = is_type(m.type, KB_MATERIAL_ROUGH_DIELECTRIC);
  const M below = wi.z < F(0), undecided = not_degraded(m);
  const M inside = below & !has_bits(m.flags, KB_MATERIAL_THIN);
  const F eta = select(inside, F(1) / index_ratio(m), index_ratio(m));
  wi = select(below, flip(wi), wi);
  if (const M lanes = active & rough & !undecided; any(lanes))
    sample_rough_dielectric(m, wi, eta, u_lobe, u, lanes, sample);
  if (const M lanes = active & !rough & !undecided; any(lanes))
    sample_dielectric(m, wi, eta, u_lobe, lanes, sample);
  if (const M lanes = active & !rough & undecided; any(lanes))
    sample_dispersive(m, wi, eta, below, u_lobe, lanes, sample);
  sample.wo = select(active & below, flip(sample.wo), sample.wo);
}

/// Lanes with a principled material, of any kind and side.
inline BsdfValue eval_any_principled(const Material& m, V3 wi, V3 wo, M active) {
  BsdfValue value = no_value();
  active = active & (abs(wi.z) > F(0)) & (abs(wo.z) > F(0));
  const M thin = has_bits(m.flags, KB_MATERIAL_THIN);
  if (const M lanes = active & !thin; any(lanes)) eval_principled(m, wi, wo, lanes, value);
  if (const M lanes = active & thin; any(lanes)) eval_sheet(m, wi, wo, lanes, value);
  return value;
}

inline void sample_any_principled(const Material& m, V3 wi, F u_lobe, V2 u, M active, BsdfSample& sample) {
  const M thin = has_bits(m.flags, KB_MATERIAL_THIN);
  const F refracts = (F(1) - number_of(m, KB_PRINCIPLED_METALLIC)) * number_of(m, KB_PRINCIPLED_SPEC_TRANS);
  if (const M lanes = active & !thin & ((wi.z > F(0)) | (refracts > F(0))); any(lanes))
    sample_principled(m, wi, u_lobe, u, lanes, sample);
  if (const M lanes = active & thin; any(lanes)) sample_sheet(m, wi, u_lobe, u, lanes, sample);
}

/// Value and density for wi -> wo; zero for delta materials and for directions that the material does not scatter to.
KB_INLINE BsdfValue eval_bsdf(const Material& m, V3 wi, V3 wo, M active) {
  BsdfValue value = no_value();
  const M above = active & (wi.z > F(0)) & (wo.z > F(0));
  const auto lanes_of = [&](KbMaterialType type) KB_LAMBDA { return above & is_type(m.type, type); };
  if (const M lanes = lanes_of(KB_MATERIAL_DIFFUSE); any(lanes)) put(value, lanes, eval_diffuse(wo));
  if (const M lanes = lanes_of(KB_MATERIAL_ROUGH_CONDUCTOR); any(lanes))
    put(value, lanes, eval_rough_conductor(m, wi, wo, lanes));
  if (const M lanes = lanes_of(KB_MATERIAL_PLASTIC); any(lanes)) put(value, lanes, eval_plastic(m, wi, wo));
  if (const M lanes = lanes_of(KB_MATERIAL_ROUGH_PLASTIC); any(lanes))
    put(value, lanes, eval_rough_plastic(m, wi, wo, lanes));
  const M glass = active & is_type(m.type, KB_MATERIAL_ROUGH_DIELECTRIC) & (abs(wi.z) > F(0)) &
                  (abs(wo.z) > F(0)) & !not_degraded(m);
  if (any(glass)) eval_dielectric_side(m, wi, wo, glass, value);
  if (m.principled)
    if (const M lanes = active & is_type(m.type, KB_MATERIAL_PRINCIPLED); any(lanes))
      put(value, lanes, eval_any_principled(m, wi, wo, lanes));
  compensate(m, wi, active, value);
  return value;
}

/// Chooses a direction; the weights are f |cos theta_o| / pdf of the whole material for non-delta lobes, and of the chosen lobe
/// for delta ones. u_lobe and u uniform in [0,1).
KB_INLINE BsdfSample sample_bsdf(const Material& m, V3 wi, F u_lobe, V2 u, M active) {
  BsdfSample sample = no_sample();
  const M above = active & (wi.z > F(0));
  const auto lanes_of = [&](KbMaterialType type) KB_LAMBDA { return above & is_type(m.type, type); };
  if (const M lanes = lanes_of(KB_MATERIAL_DIFFUSE); any(lanes)) put(sample, lanes, sample_diffuse(m, u));
  if (const M lanes = lanes_of(KB_MATERIAL_CONDUCTOR); any(lanes))
    put(sample, lanes, sample_conductor(m, wi));
  if (const M lanes = lanes_of(KB_MATERIAL_ROUGH_CONDUCTOR); any(lanes))
    sample_rough_conductor(m, wi, u, lanes, sample);
  if (const M lanes = lanes_of(KB_MATERIAL_PLASTIC); any(lanes))
    sample_plastic(m, wi, u_lobe, u, lanes, sample);
  if (const M lanes = lanes_of(KB_MATERIAL_ROUGH_PLASTIC); any(lanes))
    sample_rough_plastic(m, wi, u_lobe, u, lanes, sample);
  const M glass = active & (abs(wi.z) > F(0)) &
                  (is_type(m.type, KB_MATERIAL_DIELECTRIC) | is_type(m.type, KB_MATERIAL_ROUGH_DIELECTRIC));
  if (any(glass)) sample_dielectric_side(m, wi, u_lobe, u, glass, sample);
  if (m.principled)
    if (const M lanes = active & (abs(wi.z) > F(0)) & is_type(m.type, KB_MATERIAL_PRINCIPLED); any(lanes))
      sample_any_principled(m, wi, u_lobe, u, lanes, sample);
  compensate(m, wi, active, sample);
  return sample;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
