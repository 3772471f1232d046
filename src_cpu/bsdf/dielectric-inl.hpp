// Boundaries between dielectrics, smooth and rough. Here wi.z > 0; eta is the far side's index over that of
// wi's side. Transmitted radiance is scaled by 1 / eta^2, which `bound` leaves out.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_DIELECTRIC_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_DIELECTRIC_INL
#undef KILOBAND_BSDF_DIELECTRIC_INL
#else
#define KILOBAND_BSDF_DIELECTRIC_INL
#endif

#include "src_cpu/bsdf/fresnel-inl.hpp"
#include "src_cpu/bsdf/microfacet-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// A delta lobe. bound: of the spectral factor; passes: to the other side, where S_b is the factor
KB_INLINE BsdfSample delta_sample(V3 wo, F weight, F pdf, F bound, M passes) {
  BsdfSample sample = no_sample();
  sample.wo = wo;
  sample.w0 = weight;
  sample.pdf = pdf;
  sample.bound = weight * bound;
  sample.delta = !no_lanes();
  sample.transmission = sample.lobe_b = passes;
  return sample;
}

/// Delta transmission with weight `weight` before the radiance scaling.
KB_INLINE BsdfSample refracted(const Material& material, V3 wi, F eta, F cos_t, F weight, F pdf) {
  const V3 wo{-wi.x / eta, -wi.y / eta, -cos_t};
  BsdfSample sample = delta_sample(wo, weight, pdf, material.bound_b, !no_lanes());
  sample.w0 = weight / (eta * eta);
  sample.eta = eta;
  return sample;
}

/// Delta reflection; evaluation applies a reflectance that is left out, F <= 1.
KB_INLINE BsdfSample reflected(const Material& material, V3 wi, F weight, F pdf) {
  return delta_sample(mirror(wi), weight, pdf, material.bound_a, no_lanes());
}

/// Of a pane whose faces reflect F: F + (1 - F)^2 F (1 + F^2 + F^4 + ...) = 2 F / (1 + F). The rest passes.
KB_INLINE F pane_reflectance(F f) {
  return F(2) * f / (F(1) + f);
}

/// Through a pane light goes straight on.
KB_INLINE BsdfSample passed_pane(const Material& material, V3 wi, F weight, F pdf) {
  return delta_sample(-wi, weight, pdf, material.bound_b, !no_lanes());
}

/// Reflection with probability F: both weights are then 1 (times the radiance scaling).
KB_INLINE void sample_dielectric(const Material& material, V3 wi, F eta, F u_lobe, M active,
                                 BsdfSample& sample) {
  const M thin = has_bits(material.flags, KB_MATERIAL_THIN);
  const DielectricFresnel f = fresnel_dielectric(min(wi.z, F(1)), eta);
  const F p = select(thin, pane_reflectance(f.reflectance), f.reflectance);
  const M reflects = u_lobe < p;
  put(sample, active & reflects, reflected(material, wi, F(1), p));
  put(sample, active & !reflects & !thin, refracted(material, wi, eta, f.cos_t, F(1), F(1) - p));
  const M passes = active & !reflects & thin;
  if (any(passes)) put(sample, passes, passed_pane(material, wi, F(1), F(1) - p));
}

/// All channels are reflected into one direction, so reflection is chosen by the guide mean's F, kept within
/// [0.1, 0.9] since single channels may reflect where the mean does not (and the other way round); evaluation
/// applies F per channel. Before degradation; `below` says that wi was mirrored.
KB_INLINE void sample_dispersive(const Material& material, V3 wi, F eta, M below, F u_lobe, M active,
                                 BsdfSample& sample) {
  const M thin = has_bits(material.flags, KB_MATERIAL_THIN);
  const F f = fresnel_dielectric(min(wi.z, F(1)), eta).reflectance;
  const F p = min(max(select(thin, pane_reflectance(f), f), F(0.1f)), F(0.9f));
  const M reflects = u_lobe < p;
  BsdfSample mirrored = reflected(material, wi, F(1) / p, p);
  mirrored.kind = U(uint32_t{KB_KIND_DISPERSIVE});
  mirrored.w1 = select(below & !thin, -wi.z, wi.z);
  put(sample, active & reflects, mirrored);
  // All channels go straight on through a pane: none need be chosen.
  BsdfSample passed = passed_pane(material, wi, F(1) / (F(1) - p), F(1) - p);
  passed.kind = mirrored.kind;
  passed.w1 = -wi.z;
  put(sample, active & !reflects & thin, passed);
  BsdfSample undecided = no_sample();
  undecided.pdf = F(1) - p;
  undecided.delta = undecided.transmission = undecided.needs_channel = !no_lanes();
  put(sample, active & !reflects & !thin, undecided);
}

/// Is a rough boundary's lobe too narrow for float directions, so that it is treated as smooth?
/// eta  either ratio of the two indices
KB_INLINE M acts_smooth(const Facets& facets, F eta) {
  return min(facets.alpha_u, facets.alpha_v) * abs(eta - F(1)) < F(3e-6f);
}

/// Roughness that normals are sampled with: without visible normals slightly larger, which bounds the weights
/// better (Walter et al. 2007, section 5.3).
KB_INLINE Facets sampled_facets(const Facets& facets, F cos_i) {
  const F scale = select(facets.visible, F(1), F(1.2f) - F(0.2f) * sqrt(cos_i));
  return {facets.alpha_u * scale, facets.alpha_v * scale, facets.ggx, facets.visible};
}

struct HalfVector {
  V3 m;
  F dot_i, dot_o;  // dot_i > 0 if valid; dot_o has the sign of wo.z
  F size;          // |wi + eta wo| = |dot_i + eta dot_o|, or |wi + wo|
};

KB_INLINE HalfVector half_vector(V3 wi, V3 wo, F eta) {
  const V3 sum = wi + wo * select(wo.z > F(0), F(1), eta);
  const F size = length(sum);
  const V3 m = sum / select(sum.z < F(0), -size, size);
  const F dot_i = min(dot(wi, m), F(1));
  return {m, select(size > F(1e-10f), dot_i, F(0)), max(dot(wo, m), F(-1)), size};
}

/// Walter et al. 2007, with m the half vector of reflection or refraction and J = |dm / dwo|:
///   f cos_o = F D G1(wi) G1(wo) / (4 cos_i)                                                    reflection
///   f cos_o = (1 - F) D G1(wi) G1(wo) |wi.m| |wo.m| / (cos_i (wi.m + eta wo.m)^2)              transmission,
/// the latter with the 1 / eta^2 of radiance included. pdf = {F, 1 - F} p(m) J, J = 1 / (4 |wo.m|) for
/// reflection and eta^2 |wo.m| / (wi.m + eta wo.m)^2 for transmission. wo.z != 0.
KB_INLINE void eval_rough_dielectric(const Material& material, V3 wi, V3 wo, F eta, M active,
                                     BsdfValue& value) {
  const Facets facets = facets_of(material);
  const HalfVector half = half_vector(wi, wo, eta);
  active = active & !acts_smooth(facets, eta) & (half.dot_i > F(0)) & (half.dot_o * wo.z > F(0));
  if (!any(active)) return;
  const F f = fresnel_dielectric(half.dot_i, eta).reflectance;
  const F density = facet_density(facets, half.m, active);
  const F incident = facet_masking_over_cos(facets, wi, active);
  const F common = density * incident * facet_masking(facets, {wo.x, wo.y, abs(wo.z)}, active);
  F pdf = density * incident * max(half.dot_i, F(0));
  const M all_normals = active & !facets.visible;
  if (any(all_normals)) {
    const F wider = facet_density(sampled_facets(facets, wi.z), half.m, all_normals);
    pdf = select(facets.visible, pdf, wider * half.m.z);
  }
  const M above = wo.z > F(0);
  const F jacobian = -half.dot_o / (half.size * half.size);
  const BsdfValue reflection{F(0.25f) * f * common, F(0), f * pdf / (F(4) * half.dot_o), no_lanes()};
  const BsdfValue transmission{(F(1) - f) * common * half.dot_i * jacobian, F(0),
                               (F(1) - f) * pdf * eta * eta * jacobian, !no_lanes()};
  put(value, active & above, reflection);
  put(value, active & !above, transmission);
}

/// Where the boundary does not act as a smooth one.
KB_INLINE void sample_facet_boundary(const Material& material, V3 wi, F eta, F u_lobe, V2 u, M active,
                                     BsdfSample& sample) {
  const V3 m = sample_facet_normal(sampled_facets(facets_of(material), wi.z), wi, u, active);
  const F dot_i = dot(wi, m);
  const DielectricFresnel f = fresnel_dielectric(min(dot_i, F(1)), eta);
  const M reflects = u_lobe < f.reflectance;
  BsdfSample found = no_sample();
  found.wo = normalize(select(reflects, reflect_at(wi, m), refract_at(wi, m, f.cos_t, eta)));
  // Lost: a normal that wi cannot see (not visible-normal sampling), a direction that would scatter again.
  active = active & (dot_i > F(0)) & select(reflects, found.wo.z > F(0), found.wo.z < F(0));
  if (!any(active)) return;
  BsdfValue value = no_value();
  eval_rough_dielectric(material, wi, found.wo, eta, active, value);
  found.w0 = value.w0 / value.pdf;
  found.pdf = value.pdf;
  found.eta = select(reflects, F(1), eta);
  found.bound = found.w0 * found.eta * found.eta * select(reflects, material.bound_a, material.bound_b);
  found.transmission = found.lobe_b = !reflects;
  put(sample, active & (value.pdf > F(0)), found);
}

KB_INLINE void sample_rough_dielectric(const Material& material, V3 wi, F eta, F u_lobe, V2 u, M active,
                                       BsdfSample& sample) {
  const M smooth = acts_smooth(facets_of(material), eta);
  if (const M lanes = active & smooth; any(lanes))
    sample_dielectric(material, wi, eta, u_lobe, lanes, sample);
  if (const M lanes = active & !smooth; any(lanes))
    sample_facet_boundary(material, wi, eta, u_lobe, u, lanes, sample);
}

/// A pair of directions at a rough dispersive boundary, for every channel at once. For reflection the vertex
/// is KB_KIND_DISPERSIVE with w0 = weight, w1 = cosine; for transmission KB_KIND_ROUGH_TRANSMISSION with
/// w0 = weight and the directions (shared/rough_transmission.h).
struct BoundaryPair {
  F weight;  // f |cos theta_o| [1/sr] without Fresnel's reflectance; or without the factor T; 0: none
  F cosine;  // reflection: of wi and the half vector, negative from inside
  M transmission;
};

/// wi.z, wo.z != 0
KB_INLINE BoundaryPair rough_boundary_pair(const Material& material, V3 wi, V3 wo, M active) {
  const M below = wi.z < F(0);
  wi = select(below, flip(wi), wi);
  wo = select(below, flip(wo), wo);
  const Facets facets = facets_of(material);
  const F masking =
      facet_masking_over_cos(facets, wi, active) * facet_masking(facets, {wo.x, wo.y, abs(wo.z)}, active);
  const M transmission = wo.z < F(0);
  const HalfVector half = half_vector(wi, wo, F(1));
  const M reflection = active & !transmission & (half.dot_i > F(0)) & (half.dot_o > F(0));
  const F density = facet_density(facets, half.m, reflection);
  F weight = select(active & transmission, masking, F(0));
  weight = select(reflection, F(0.25f) * density * masking, weight);
  return {weight, select(reflection, select(below, -half.dot_i, half.dot_i), F(0)), active & transmission};
}

/// Second half of a sample with needs_channel: refracts wi for the chosen channel.
/// eta_channel  interior over exterior index at the channel's wavelength
/// probability  of getting here: the sample's pdf times the probability of the channel
/// returns pdf == 0 on total internal reflection (this channel is carried by the reflected sample alone)
KB_INLINE BsdfSample transmit_dispersive(const Material& material, V3 wi, F eta_channel, F probability,
                                         M active) {
  const M below = wi.z < F(0);
  const F eta = select(below, F(1) / eta_channel, eta_channel);
  wi = select(below, flip(wi), wi);
  const DielectricFresnel f = fresnel_dielectric(min(wi.z, F(1)), eta);
  active = active & (wi.z > F(0)) & (eta_channel > F(0)) & (probability > F(0)) & (f.reflectance < F(1));
  BsdfSample found = refracted(material, wi, eta, f.cos_t, (F(1) - f.reflectance) / probability, probability);
  found.wo = select(below, flip(found.wo), found.wo);
  BsdfSample sample = no_sample();
  put(sample, active, found);
  return sample;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
