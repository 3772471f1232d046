// The principled material, thick: `principled` of Mitsuba 3 (shared/principled.h). wi may be on both sides.
//
// With m the metallic, t the spec_trans part, F of dielectrics, s = Schlick's (1 - cos)^5, S the base colour, from above:
//
//   specular    D G / (4 cos_i) ((1 - m) (1 - tint) F + m (S + (1 - S) s) + (1 - m) tint (C R0 + (1 - C R0) s))
//   refraction  (1 - m) t sqrt(S) times that of a rough dielectric
//   clearcoat   clearcoat / 4 (0.04 + 0.96 s) D_cc G_cc cos_o
//   diffuse     (1 - m) (1 - t) S / pi cos_o (1 - flatness) (lambert + retro-reflection) + flatness (subsurface)
//   sheen       (1 - m) sheen (1 - cos)^5 cos_o (1 - sheen_tint + sheen_tint C)
//
// C = S / luminance, R0 = ((eta - 1) / (eta + 1))^2. From below: (1 - m) t F and the refraction.
//
// Sampled: diffuse directions by the cosine, clearcoat by its normals, specular and refraction by visible normals, of
// which one reflects with the part that it reflects of what it sends on. pdf is that of all lobes.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_PRINCIPLED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_PRINCIPLED_INL
#undef KILOBAND_BSDF_PRINCIPLED_INL
#else
#define KILOBAND_BSDF_PRINCIPLED_INL
#endif

#include "src_cpu/bsdf/dielectric-inl.hpp"
#include "src_cpu/bsdf/principled_common-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

struct PrincipledLobes {
  F diffuse, clearcoat, specular;  // probabilities
};

/// wi.z > 0; below: wi was mirrored
KB_INLINE PrincipledLobes principled_lobes(const Material& m, V3 wi, M below) {
  const F dielectric = F(1) - number_of(m, KB_PRINCIPLED_METALLIC);
  const F trans = number_of(m, KB_PRINCIPLED_SPEC_TRANS), base = sampled_base(m);
  const F cosine = min(wi.z, F(1));
  const F index = number_of(m, KB_PRINCIPLED_ETA), f = fresnel_dielectric(cosine, index).reflectance;
  const F reflected = dielectric_reflection(m, f, schlick_share(cosine, index));
  const F weights[3] = {
      dielectric * (F(1) - trans) * base + F(0.1f) * dielectric * number_of(m, KB_PRINCIPLED_SHEEN),
      F(0.25f) * number_of(m, KB_PRINCIPLED_CLEARCOAT) * (F(0.04f) + F(0.96f) * schlick_weight(cosine)),
      (F(1) - dielectric) * base + dielectric * (reflected + trans * (F(1) - f))};
  const uint32_t rates[3] = {0, 2, 1};
  F p[3];
  lobe_probabilities(m, weights, rates, p);
  return {select(below, F(0), p[0]), select(below, F(0), p[1]), select(below, F(1), p[2])};
}

/// The part of a normal's light that it reflects. share: Schlick's s.
KB_INLINE F reflected_part(const Material& m, F f, F share, M below) {
  const F metallic = number_of(m, KB_PRINCIPLED_METALLIC), base = sampled_base(m);
  const F passes = number_of(m, KB_PRINCIPLED_SPEC_TRANS);
  const F reflected =
      metallic * (base + (F(1) - base) * share) + (F(1) - metallic) * dielectric_reflection(m, f, share);
  const F refracted = (F(1) - metallic) * passes * (F(1) - f);
  return select(below, f, select(refracted > F(0), reflected / (reflected + refracted), F(1)));
}

/// wo.z > 0, both above. half: of reflection
KB_INLINE void add_clearcoat(const Material& m, V3 wi, V3 wo, const HalfVector& half, F probability,
                             BsdfValue& value) {
  const F clearcoat = number_of(m, KB_PRINCIPLED_CLEARCOAT);
  const F alpha = clearcoat_alpha(m);
  const F density = clearcoat_density(half.m.z, alpha);
  const F fresnel = F(0.04f) + F(0.96f) * schlick_share(half.dot_i, number_of(m, KB_PRINCIPLED_ETA));
  const F masking = clearcoat_masking(wi.z) * clearcoat_masking(wo.z);
  value.w1 = value.w1 + F(0.25f) * clearcoat * fresnel * density * masking * wo.z;
  value.pdf = value.pdf + probability * density * half.m.z / (F(4) * half.dot_i);
}

/// wi.z > 0, wo.z > 0. spec: D G / (4 cos_i)
KB_INLINE BsdfValue reflected_principled(const Material& m, V3 wi, V3 wo, const HalfVector& half, F f, F spec,
                                         F pdf, M below) {
  const F metallic = number_of(m, KB_PRINCIPLED_METALLIC), dielectric = F(1) - metallic;
  const F tint = number_of(m, KB_PRINCIPLED_SPEC_TINT), trans = number_of(m, KB_PRINCIPLED_SPEC_TRANS);
  const F share = schlick_share(half.dot_i, number_of(m, KB_PRINCIPLED_ETA));
  const PrincipledLobes lobes = principled_lobes(m, wi, below);
  const F specular = lobes.specular * reflected_part(m, f, share, below) * pdf;

  BsdfValue value = no_value();
  value.w0 = spec * metallic * (F(1) - share);
  value.w1 = spec * (dielectric * (F(1) - tint) * f + (metallic + dielectric * tint) * share);
  add_tinted(m, spec * dielectric * tint * (F(1) - share) * normal_reflectance(m), F(1), value);
  add_diffuse(m, wi, wo, half.dot_i, dielectric * (F(1) - trans), dielectric, value);
  value.pdf = specular + lobes.diffuse * wo.z * F(KB_INV_PI);
  add_clearcoat(m, wi, wo, half, lobes.clearcoat, value);

  put(value, below, BsdfValue{F(0), spec * dielectric * trans * f, specular, no_lanes()});
  return value;
}

/// Any side; wi.z, wo.z != 0.
KB_INLINE void eval_principled(const Material& m, V3 wi, V3 wo, M active, BsdfValue& value) {
  const M below = wi.z < F(0);
  wi = select(below, flip(wi), wi);
  wo = select(below, flip(wo), wo);
  const F index = number_of(m, KB_PRINCIPLED_ETA), eta = select(below, F(1) / index, index);
  const M above = wo.z > F(0);
  const F refracts = (F(1) - number_of(m, KB_PRINCIPLED_METALLIC)) * number_of(m, KB_PRINCIPLED_SPEC_TRANS);
  const HalfVector half = half_vector(wi, wo, eta);
  active = active & (half.dot_i > F(0)) & (half.dot_o * wo.z > F(0)) & ((above & !below) | (refracts > F(0)));
  if (!any(active)) return;
  const Facets facets = facets_of(m);
  const F f = fresnel_dielectric(half.dot_i, eta).reflectance;
  const F visible = facet_density(facets, half.m, active) * facet_masking_over_cos(facets, wi, active);
  const F common = visible * facet_masking(facets, {wo.x, wo.y, abs(wo.z)}, active);
  if (const M lanes = active & above; any(lanes))
    put(value, lanes, reflected_principled(m, wi, wo, half, f, F(0.25f) * common, F(0.25f) * visible, below));
  if (const M lanes = active & !above; any(lanes)) {
    const F jacobian = -half.dot_o / (half.size * half.size);
    const F share = schlick_share(half.dot_i, index);
    const F chosen = principled_lobes(m, wi, below).specular * (F(1) - reflected_part(m, f, share, below));
    const F weight = refracts * (F(1) - f) * common * half.dot_i * jacobian;
    put(value, lanes,
        BsdfValue{F(0), -weight, chosen * visible * half.dot_i * eta * eta * jacobian, no_lanes()});
  }
}

KB_INLINE void sample_principled(const Material& m, V3 wi, F u_lobe, V2 u, M active, BsdfSample& sample) {
  const M below = wi.z < F(0);
  const V3 up = select(below, flip(wi), wi);
  const F index = number_of(m, KB_PRINCIPLED_ETA), eta = select(below, F(1) / index, index);
  const PrincipledLobes lobes = principled_lobes(m, up, below);
  // The sum of the probabilities is 1 but for rounding: nothing without a probability is chosen for that.
  const F before = lobes.diffuse + lobes.clearcoat;
  const M last = u_lobe >= before;
  const M diffuse = (u_lobe < lobes.diffuse) | (last & !(lobes.specular > F(0)));
  const M clearcoat = !(diffuse | last);
  const M specular = active & !diffuse & !clearcoat;
  V3 wo{F(0), F(0), F(0)};
  if (any(active & diffuse)) wo = cosine_hemisphere(u.x, u.y);
  if (const M lanes = active & clearcoat; any(lanes))
    wo = select(lanes, reflect_at(up, clearcoat_normal(clearcoat_alpha(m), u)), wo);
  M reflects = !no_lanes();
  if (any(specular)) {
    const V3 normal = sample_facet_normal(facets_of(m), up, u, specular);
    const F dot_i = min(dot(up, normal), F(1));
    const DielectricFresnel f = fresnel_dielectric(dot_i, eta);
    const F rest = min((u_lobe - before) / lobes.specular, F(KB_ONE_MINUS_EPSILON));
    reflects = (rest < reflected_part(m, f.reflectance, schlick_share(dot_i, index), below)) | !specular;
    wo = select(specular & reflects, reflect_at(up, normal), wo);
    wo = select(specular & !reflects, refract_at(up, normal, f.cos_t, eta), wo);
    active = active & ((dot_i > F(0)) | !specular);
  }
  active = active & select(reflects, wo.z > F(0), wo.z < F(0));
  if (any(active)) finish_principled(m, wi, normalize(wo), below, eta, active, sample);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
