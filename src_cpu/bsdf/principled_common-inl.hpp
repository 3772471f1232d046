// What principled materials have in common, thick and thin: their numbers, diffuse light, sheen, clearcoat.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_PRINCIPLED_COMMON_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_PRINCIPLED_COMMON_INL
#undef KILOBAND_BSDF_PRINCIPLED_COMMON_INL
#else
#define KILOBAND_BSDF_PRINCIPLED_COMMON_INL
#endif

#include "src_cpu/bsdf/fresnel-inl.hpp"
#include "src_cpu/bsdf/microfacet-inl.hpp"
#include "src_cpu/lanes/lane_sampler-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

KB_INLINE F number_of(const Material& m, KbPrincipledNumber n) {
  return m.principled->number[n];
}

/// The numbers that begin at `table` of `tables`; any in lanes that are not asked for.
KB_INLINE Principled gather_principled(const float* tables, U table, M lanes) {
  const U first = select(lanes, table, U(0u));
  Principled p;
  for (uint32_t n = 0; n < KB_PRINCIPLED_NUMBERS; ++n)
    p.number[n] = gather(tables, select(lanes, first + U(n), U(0u)));
  return p;
}

/// Alpha of a roughness r: r^2 over and times the aspect sqrt(1 - 0.9 anisotropic).
KB_INLINE Facets principled_facets(const Material& m, F roughness) {
  const F aspect = sqrt(F(1) - F(0.9f) * number_of(m, KB_PRINCIPLED_ANISOTROPIC));
  const F alpha = roughness * roughness, least(KB_PRINCIPLED_LEAST_ALPHA);
  return {max(alpha / aspect, least), max(alpha * aspect, least), !no_lanes(), !no_lanes()};
}

KB_INLINE void set_principled_alpha(Material& m, M lanes) {
  const Facets facets = principled_facets(m, number_of(m, KB_PRINCIPLED_ROUGHNESS));
  m.alpha_u = select(lanes, facets.alpha_u, m.alpha_u);
  m.alpha_v = select(lanes, facets.alpha_v, m.alpha_v);
}

/// (1 - cos)^5
KB_INLINE F schlick_weight(F cosine) {
  const F x = min(max(F(1) - cosine, F(0)), F(1)), x2 = x * x;
  return x2 * x2 * x;
}

/// From the denser side, of the refracted direction.
KB_INLINE F schlick_share(F cosine, F eta) {
  return schlick_weight(select(eta > F(1), cosine, fresnel_dielectric(cosine, eta).cos_t));
}

/// Of dielectrics at normal incidence.
KB_INLINE F normal_reflectance(const Material& m) {
  const F eta = number_of(m, KB_PRINCIPLED_ETA), r = (eta - F(1)) / (eta + F(1));
  return r * r;
}

/// The part of white light that the dielectric's facets reflect: F, of which the tint replaces its share by Schlick's
/// R0 + (1 - R0) s. The two are far apart where the index is near 1: F is 0 almost everywhere and s is not.
/// share: s
KB_INLINE F dielectric_reflection(const Material& m, F f, F share) {
  const F schlick = normal_reflectance(m) * (F(1) - share) + share;
  return f + number_of(m, KB_PRINCIPLED_SPEC_TINT) * (schlick - f);
}

/// What sampling takes the base colour for.
KB_INLINE F sampled_base(const Material& m) {
  return F(KB_PRINCIPLED_LEAST_BASE) + F(1 - KB_PRINCIPLED_LEAST_BASE) * number_of(m, KB_PRINCIPLED_BASE);
}

/// amount (1 - tint + tint S / luminance)
KB_INLINE void add_tinted(const Material& m, F amount, F tint, BsdfValue& value) {
  const F luminance = number_of(m, KB_PRINCIPLED_LUMINANCE);
  const F part = select(luminance > F(KB_PRINCIPLED_LEAST_LUMINANCE), tint, F(0));
  value.w0 = value.w0 + select(part > F(0), amount * part / luminance, F(0));
  value.w1 = value.w1 + amount * (F(1) - part);
}

/// Diffuse reflection (Burley 2012), its flat part (Burley 2015, of Hanrahan and Krueger's) and sheen.
/// wi.z, wo.z > 0; dot_h: of either with the half vector
KB_INLINE void add_diffuse(const Material& m, V3 wi, V3 wo, F dot_h, F share, F sheen_share,
                           BsdfValue& value) {
  const F f_i = schlick_weight(wi.z), f_o = schlick_weight(wo.z);
  const F retro = F(2) * number_of(m, KB_PRINCIPLED_ROUGHNESS) * dot_h * dot_h;
  const F lambert = (F(1) - F(0.5f) * f_i) * (F(1) - F(0.5f) * f_o);
  const F round = lambert + retro * (f_o + f_i + f_o * f_i * (retro - F(1)));
  const F grazing = F(0.5f) * retro - F(1);
  const F subsurface = (F(1) + grazing * f_o) * (F(1) + grazing * f_i);
  const F flat = F(1.25f) * (subsurface * (F(1) / (wo.z + wi.z) - F(0.5f)) + F(0.5f));
  const F flatness = number_of(m, KB_PRINCIPLED_FLATNESS);
  value.w0 = value.w0 + share * F(KB_INV_PI) * wo.z * (round + flatness * (flat - round));
  const F sheen = sheen_share * number_of(m, KB_PRINCIPLED_SHEEN) * schlick_weight(dot_h) * wo.z;
  add_tinted(m, sheen, number_of(m, KB_PRINCIPLED_SHEEN_TINT), value);
}

/// ---- clearcoat: normals of D = (a^2 - 1) / (pi ln a^2 (1 + (a^2 - 1) cos^2)), masked as GGX of alpha 1/4 ----
KB_INLINE F clearcoat_alpha(const Material& m) {
  const F gloss = number_of(m, KB_PRINCIPLED_CLEARCOAT_GLOSS);
  return F(0.1f) + gloss * F(0.001f - 0.1f);
}

KB_INLINE F clearcoat_density(F cosine, F alpha) {
  const F a2 = alpha * alpha, less = a2 - F(1);
  return less / (F(KB_PI) * log(a2) * (F(1) + less * cosine * cosine));
}

KB_INLINE F clearcoat_masking(F cosine) {
  const F c2 = cosine * cosine;
  return F(2) * cosine / (cosine + sqrt(F(0.0625f) + F(1 - 0.0625f) * c2));
}

/// Of density D cos.
KB_INLINE V3 clearcoat_normal(F alpha, V2 u) {
  const F a2 = alpha * alpha;
  const F c2 = min((F(1) - exp(log(a2) * (F(1) - u.x))) / (F(1) - a2), F(1));
  const F s = sqrt(max(F(1) - c2, F(0)));
  const SinCos azimuth = sin_cos_of_turns(u.y);
  return {s * azimuth.cos, s * azimuth.sin, sqrt(c2)};
}

/// p: of lobes of these weights times their rates; each that has a weight at least KB_PRINCIPLED_LEAST_LOBE.
template <std::size_t Count>
KB_INLINE void lobe_probabilities(const Material& m, const F (&weights)[Count],
                                  const uint32_t (&rates)[Count], F (&p)[Count]) {
  F total(0), present(0);
  for (std::size_t i = 0; i < Count; ++i) {
    p[i] = weights[i] * m.principled->number[KB_PRINCIPLED_RATES + rates[i]];
    total = total + p[i];
    present = present + select(weights[i] > F(0), F(1), F(0));
  }
  const F even(KB_PRINCIPLED_LEAST_LOBE);
  for (std::size_t i = 0; i < Count; ++i) {
    const F share = select(total > F(0), p[i] / total, select(weights[i] > F(0), F(1) / present, F(0)));
    p[i] = (F(1) - even * present) * share + select(weights[i] > F(0), even, F(0));
  }
}

inline BsdfValue eval_any_principled(const Material& m, V3 wi, V3 wo, M active);

/// Weights and density are those of all lobes. wo: for wi above; eta: of the sides if it is refracted
KB_INLINE void finish_principled(const Material& m, V3 wi, V3 wo, M below, F eta, M active,
                                 BsdfSample& sample) {
  const M passes = wo.z < F(0);
  BsdfSample found = no_sample();
  found.wo = select(below, flip(wo), wo);
  const BsdfValue value = eval_any_principled(m, wi, found.wo, active);
  found.kind = U(uint32_t{KB_KIND_TINTED});
  found.w0 = value.w0 / value.pdf;
  found.w1 = value.w1 / value.pdf;
  found.pdf = value.pdf;
  found.transmission = passes;
  found.eta = select(passes, eta, F(1));
  const F root = select(found.w1 < F(0), sqrt(m.bound_a), F(1));
  found.bound = (found.w0 * m.bound_a + abs(found.w1) * root) * found.eta * found.eta;
  put(sample, active & (value.pdf > F(0)), found);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
