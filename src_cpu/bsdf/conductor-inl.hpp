// Metals. Fresnel's factor depends on wavelength: evaluation applies it at the cosine w1. wi.z > 0.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_CONDUCTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_CONDUCTOR_INL
#undef KILOBAND_BSDF_CONDUCTOR_INL
#else
#define KILOBAND_BSDF_CONDUCTOR_INL
#endif

#include "src_cpu/bsdf/fresnel-inl.hpp"
#include "src_cpu/bsdf/microfacet-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// A perfect mirror has no factor that depends on the cosine.
KB_INLINE F cosine_of_factor(const Material& material, F cosine) {
  return select(has_bits(material.flags, KB_MATERIAL_PERFECT_MIRROR), F(0), cosine);
}

KB_INLINE BsdfSample sample_conductor(const Material& material, V3 wi) {
  BsdfSample sample = no_sample();
  sample.wo = mirror(wi);
  sample.kind = eval_kind(material.type, material.flags);
  sample.w0 = F(1);
  sample.w1 = cosine_of_factor(material, wi.z);
  sample.pdf = F(1);
  sample.bound = material.bound_a;  // F <= 1
  sample.delta = !no_lanes();
  return sample;
}

/// f cos_o = F(wi.h) D(h) G1(wi) G1(wo) / (4 cos_i)   (Torrance-Sparrow)
KB_INLINE BsdfValue eval_rough_conductor(const Material& material, V3 wi, V3 wo, M active) {
  const FacetReflection r = facet_reflection(facets_of(material), wi, wo, active);
  return {r.value, cosine_of_factor(material, r.dot_ih), r.pdf, no_lanes()};
}

KB_INLINE void sample_rough_conductor(const Material& material, V3 wi, V2 u, M active, BsdfSample& sample) {
  const V3 wo = normalize(reflect_at(wi, sample_facet_normal(facets_of(material), wi, u, active)));
  active = active & (wo.z > F(0));  // single scattering: light below the horizon is lost
  if (!any(active)) return;
  const BsdfValue value = eval_rough_conductor(material, wi, wo, active);
  BsdfSample found = no_sample();
  found.wo = wo;
  found.kind = eval_kind(material.type, material.flags);
  found.w0 = value.w0 / value.pdf;
  found.w1 = value.w1;
  found.pdf = value.pdf;
  found.bound = found.w0 * material.bound_a;
  put(sample, active & (value.pdf > F(0)), found);
}

/// kb_conductor_bound() of shared/material_tables.h: upper bounds of the reflectance over all channels.
KB_INLINE F conductor_bound(const Material& material, F cosine, M active) {
  const M bounded = active & (material.table != U(KB_NONE));
  if (!any(bounded)) return F(1);
  const F x = min(max(cosine, F(0)), F(1)) * F(KB_CONDUCTOR_CELLS);
  const U cell = to_words(min(x, F(KB_CONDUCTOR_CELLS - 1)));
  const U place = select(bounded, material.table + cell, U(0u));
  const F bound = max(gather(material.tables, place), gather(material.tables, place + U(1u)));
  return select(bounded, bound, F(1));
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
