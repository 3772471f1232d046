// A diffuse base under a dielectric coating, smooth and rough (Mitsuba 3's model). wi.z > 0, wo.z > 0.
//
//   specular  F(wi) delta, or F D G / (4 cos_i)
//   diffuse   rho / (1 - rho' + rho' e) T(cos_i) T(cos_o) cos_o / (pi eta^2),   rho' = rho if nonlinear, else 1
//
// T = 1 - F for the smooth coating and the tabulated transmittance for the rough one; e = 1 - R_int, `escape`, is kept
// instead of R_int, of which 1 - R_int = 1 / 250,000 could not be had at index 1000. w0 goes with S_a
// (specular), w1 with S_b (diffuse); for KB_KIND_NONLINEAR the denominator is applied by evaluation.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_PLASTIC_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_PLASTIC_INL
#undef KILOBAND_BSDF_PLASTIC_INL
#else
#define KILOBAND_BSDF_PLASTIC_INL
#endif

#include "src_cpu/bsdf/fresnel-inl.hpp"
#include "src_cpu/bsdf/microfacet-inl.hpp"
#include "src_cpu/lanes/lane_sampler-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

KB_INLINE M is_nonlinear(const Material& material) {
  return has_bits(material.flags, KB_MATERIAL_NONLINEAR);
}

/// Mitsuba's choice by reflected fraction and guide means, mixed with uniform: each lobe has at least 5 %.
KB_INLINE F specular_probability(const Material& material, F reflectance) {
  const F s = reflectance * material.specular_weight;
  const F d = (F(1) - reflectance) * (F(1) - material.specular_weight);
  const F p = select(s + d > F(0), s / (s + d), F(0.5f));
  return F(1 - KB_UNIFORM_LOBES) * p + F(0.5f * KB_UNIFORM_LOBES);
}

/// The diffuse term's part that depends on the material alone;
/// the denominator stays out for KB_KIND_NONLINEAR.
KB_INLINE F diffuse_scale(const Material& material) {
  const F scale = F(1) / (material.eta * material.eta);
  return select(is_nonlinear(material), scale, scale / material.escape);
}

KB_INLINE F bound_of_lobes(const Material& material, F w0, F w1) {
  const F b = material.bound_b;
  const F diffuse = select(is_nonlinear(material), b / (F(1) - b + b * material.escape), b);
  return w0 * material.bound_a + w1 * diffuse;
}

KB_INLINE BsdfSample plastic_sample(const Material& material, V3 wo, F w0, F w1, F pdf) {
  BsdfSample sample = no_sample();
  sample.wo = wo;
  sample.kind = eval_kind(material.type, material.flags);
  sample.w0 = w0;
  sample.w1 = w1;
  sample.pdf = pdf;
  sample.bound = bound_of_lobes(material, w0, w1);
  return sample;
}

KB_INLINE F coating_reflectance(const Material& material, F cos_theta) {
  return fresnel_dielectric(min(cos_theta, F(1)), material.eta).reflectance;
}

/// kb_coat_transmittance() of the lanes of `active`, which have a table.
KB_INLINE F coat_transmittance(const Material& material, F cosine, M active) {
  const F x = min(max(cosine, F(0)), F(1)) * F(KB_COAT_NODES - 1);
  const F node = min(floor(x), F(KB_COAT_NODES - 2));
  const U place = select(active, material.table + to_words(node), U(0u));
  const F value = gather(material.tables, place), next = gather(material.tables, place + U(1u));
  return value + (x - node) * (next - value);
}

KB_INLINE BsdfValue eval_plastic(const Material& material, V3 wi, V3 wo) {
  const F f_i = coating_reflectance(material, wi.z), f_o = coating_reflectance(material, wo.z);
  const F lambert = wo.z * F(KB_INV_PI);
  const F w1 = (F(1) - f_i) * (F(1) - f_o) * diffuse_scale(material) * lambert;
  return {F(0), w1, (F(1) - specular_probability(material, f_i)) * lambert, no_lanes()};
}

KB_INLINE void sample_plastic(const Material& material, V3 wi, F u_lobe, V2 u, M active, BsdfSample& sample) {
  const F f_i = coating_reflectance(material, wi.z);
  const F p = specular_probability(material, f_i);
  const M specular = u_lobe < p;
  if (const M lanes = active & specular; any(lanes)) {
    BsdfSample mirrored = plastic_sample(material, mirror(wi), f_i / p, F(0), p);
    mirrored.delta = !no_lanes();
    put(sample, lanes, mirrored);
  }
  if (const M lanes = active & !specular; any(lanes)) {
    const V3 wo = cosine_hemisphere(u.x, u.y);
    const F f_o = coating_reflectance(material, wo.z);
    const F w1 = (F(1) - f_i) * (F(1) - f_o) * diffuse_scale(material) / (F(1) - p);
    put(sample, lanes, plastic_sample(material, wo, F(0), w1, (F(1) - p) * wo.z * F(KB_INV_PI)));
  }
}

KB_INLINE BsdfValue eval_rough_plastic(const Material& material, V3 wi, V3 wo, M active) {
  const F t_i = coat_transmittance(material, wi.z, active), t_o = coat_transmittance(material, wo.z, active);
  const F p = specular_probability(material, F(1) - t_i);
  const FacetReflection r = facet_reflection(facets_of(material), wi, wo, active);
  const F lambert = wo.z * F(KB_INV_PI);
  const F w1 = t_i * t_o * diffuse_scale(material) * lambert;
  const F pdf = p * r.pdf + (F(1) - p) * lambert;
  return {coating_reflectance(material, r.dot_ih) * r.value, w1, pdf, no_lanes()};
}

/// The lobes overlap, so weights and density are those of the whole material.
KB_INLINE void sample_rough_plastic(const Material& material, V3 wi, F u_lobe, V2 u, M active,
                                    BsdfSample& sample) {
  const F p = specular_probability(material, F(1) - coat_transmittance(material, wi.z, active));
  const M specular = u_lobe < p;
  V3 wo{F(0), F(0), F(0)};
  if (any(active & !specular)) wo = cosine_hemisphere(u.x, u.y);
  if (const M lanes = active & specular; any(lanes)) {
    const V3 m = sample_facet_normal(facets_of(material), wi, u, lanes);
    wo = select(lanes, normalize(reflect_at(wi, m)), wo);
  }
  active = active & (wo.z > F(0));
  if (!any(active)) return;
  const BsdfValue value = eval_rough_plastic(material, wi, wo, active);
  const F w0 = value.w0 / value.pdf, w1 = value.w1 / value.pdf;
  put(sample, active & (value.pdf > F(0)), plastic_sample(material, wo, w0, w1, value.pdf));
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
