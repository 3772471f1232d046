// The principled material of thin sheets: `principledthin` of Mitsuba 3 (shared/principled.h), the same on both sides.
//
// With t the spec_trans part and d half the diff_trans part, F, s, S, C, R0 as in principled-inl.hpp:
//
//   specular       t D G / (4 cos_i) ((1 - tint) F + tint (C R0 + (1 - C R0) s))
//   transmission   t (1 - F) S D G / (4 cos_i) of wo mirrored at the sheet, its roughness times 0.65 eta - 0.35;
//                  0 where wo is on the half vector's side
//   diffuse, sheen as of thick ones times (1 - t) (1 - d);  through the sheet (1 - t) d S / pi |cos_o|
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_PRINCIPLED_THIN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_PRINCIPLED_THIN_INL
#undef KILOBAND_BSDF_PRINCIPLED_THIN_INL
#else
#define KILOBAND_BSDF_PRINCIPLED_THIN_INL
#endif

#include "src_cpu/bsdf/dielectric-inl.hpp"
#include "src_cpu/bsdf/principled_common-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

struct SheetLobes {
  F diffuse, specular, passes, scatters;  // probabilities: two of reflection, two of transmission
};

KB_INLINE F diffuse_transmission(const Material& m) {
  return F(0.5f) * number_of(m, KB_PRINCIPLED_DIFF_TRANS);
}

/// wi.z > 0
KB_INLINE SheetLobes sheet_lobes(const Material& m, V3 wi) {
  const F trans = number_of(m, KB_PRINCIPLED_SPEC_TRANS), base = sampled_base(m), d = diffuse_transmission(m);
  const F cosine = min(wi.z, F(1)), eta = number_of(m, KB_PRINCIPLED_ETA);
  const F f = fresnel_dielectric(cosine, eta).reflectance, diffuse = (F(1) - trans) * (F(1) - d);
  const F reflected = dielectric_reflection(m, f, schlick_share(cosine, eta));
  const F weights[4] = {diffuse * base + F(0.1f) * diffuse * number_of(m, KB_PRINCIPLED_SHEEN),
                        trans * reflected, trans * (F(1) - f) * base, (F(1) - trans) * d * base};
  const uint32_t rates[4] = {0, 1, 2, 3};
  F p[4];
  lobe_probabilities(m, weights, rates, p);
  return {p[0], p[1], p[2], p[3]};
}

/// Light that passes a sheet by facets leaves on the other side of their normals. mirrored: wo at the sheet
KB_INLINE M on_other_side(V3 wi, V3 mirrored) {
  return dot(flip(mirrored), wi + mirrored) < F(0);
}

KB_INLINE Facets sheet_facets(const Material& m) {
  const F scale = F(0.65f) * number_of(m, KB_PRINCIPLED_ETA) - F(0.35f);
  return principled_facets(m, scale * number_of(m, KB_PRINCIPLED_ROUGHNESS));
}

/// wi.z, wo.z > 0
KB_INLINE BsdfValue reflected_by_sheet(const Material& m, V3 wi, V3 wo, const SheetLobes& lobes, M active) {
  const F eta = number_of(m, KB_PRINCIPLED_ETA), tint = number_of(m, KB_PRINCIPLED_SPEC_TINT);
  const F trans = number_of(m, KB_PRINCIPLED_SPEC_TRANS);
  const FacetReflection r = facet_reflection(facets_of(m), wi, wo, active);
  const F f = fresnel_dielectric(r.dot_ih, eta).reflectance, share = schlick_share(r.dot_ih, eta);
  BsdfValue value = no_value();
  value.w1 = trans * r.value * ((F(1) - tint) * f + tint * share);
  add_tinted(m, trans * r.value * tint * (F(1) - share) * normal_reflectance(m), F(1), value);
  const F diffuse = (F(1) - trans) * (F(1) - diffuse_transmission(m));
  add_diffuse(m, wi, wo, r.dot_ih, diffuse, diffuse, value);
  value.pdf = lobes.specular * r.pdf + lobes.diffuse * wo.z * F(KB_INV_PI);
  return value;
}

/// wi.z > 0, wo.z < 0
KB_INLINE BsdfValue passed_by_sheet(const Material& m, V3 wi, V3 wo, const SheetLobes& lobes, M active) {
  const F trans = number_of(m, KB_PRINCIPLED_SPEC_TRANS), lambert = -wo.z * F(KB_INV_PI);
  const V3 mirrored = flip(wo);
  const FacetReflection r = facet_reflection(sheet_facets(m), wi, mirrored, active);
  const M other_side = on_other_side(wi, mirrored);
  const F f = fresnel_dielectric(r.dot_ih, number_of(m, KB_PRINCIPLED_ETA)).reflectance;
  const F specular = select(other_side, trans * (F(1) - f) * r.value, F(0));
  return {specular + (F(1) - trans) * diffuse_transmission(m) * lambert, F(0),
          select(other_side, lobes.passes * r.pdf, F(0)) + lobes.scatters * lambert, no_lanes()};
}

/// Any side; wi.z, wo.z != 0.
KB_INLINE void eval_sheet(const Material& m, V3 wi, V3 wo, M active, BsdfValue& value) {
  const M below = wi.z < F(0);
  wi = select(below, flip(wi), wi);
  wo = select(below, flip(wo), wo);
  const SheetLobes lobes = sheet_lobes(m, wi);
  const M above = wo.z > F(0);
  if (const M lanes = active & above; any(lanes))
    put(value, lanes, reflected_by_sheet(m, wi, wo, lobes, lanes));
  if (const M lanes = active & !above; any(lanes))
    put(value, lanes, passed_by_sheet(m, wi, wo, lobes, lanes));
}

KB_INLINE void sample_sheet(const Material& m, V3 wi, F u_lobe, V2 u, M active, BsdfSample& sample) {
  const M below = wi.z < F(0);
  const V3 up = select(below, flip(wi), wi);
  const SheetLobes lobes = sheet_lobes(m, up);
  const F first = lobes.diffuse + lobes.scatters;
  // The sum of the probabilities is 1 but for rounding: nothing without a probability is chosen for that.
  const M diffuse = (u_lobe < first) | !(lobes.specular + lobes.passes > F(0));
  const M passes = select(diffuse, (u_lobe >= lobes.diffuse) & (lobes.scatters > F(0)),
                          (u_lobe >= first + lobes.specular) & (lobes.passes > F(0)));
  V3 wo{F(0), F(0), F(0)};
  if (any(active & diffuse)) wo = cosine_hemisphere(u.x, u.y);
  if (const M lanes = active & !diffuse & !passes; any(lanes))
    wo = select(lanes, reflect_at(up, sample_facet_normal(facets_of(m), up, u, lanes)), wo);
  if (const M lanes = active & !diffuse & passes; any(lanes))
    wo = select(lanes, reflect_at(up, sample_facet_normal(sheet_facets(m), up, u, lanes)), wo);
  active = active & (wo.z > F(0)) & (diffuse | !passes | on_other_side(up, wo));
  wo = select(passes, flip(wo), wo);
  if (any(active)) finish_principled(m, wi, normalize(wo), below, F(1), active, sample);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
