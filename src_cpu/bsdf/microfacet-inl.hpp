// Beckmann and GGX distributions of microfacet normals with Smith's masking.
//
// All vectors are in the local shading frame. Directions v have v.z > 0: callers mirror what comes from
// below. Sources: Walter et al. 2007 (distributions, masking), Heitz and d'Eon 2014 (visible normals), Dupuy
// and Benyoub 2023 (visible GGX normals from a spherical cap).
//
// What is expensive is done where a lane of `active` needs it; other lanes are left with any number.
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_MICROFACET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_MICROFACET_INL
#undef KILOBAND_BSDF_MICROFACET_INL
#else
#define KILOBAND_BSDF_MICROFACET_INL
#endif

#include "shared/estimator.h"
#include "src_cpu/bsdf/common-inl.hpp"
#include "src_cpu/lanes/lane_math-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

struct Facets {
  F alpha_u, alpha_v;  // >= KB_MIN_ALPHA
  M ggx;               // else Beckmann
  M visible;           // sample visible normals
};

inline constexpr float kInvSqrtPi = 0.56418958354775628695f;

KB_INLINE Facets facets_of(const Material& m) {
  return {max(m.alpha_u, F(KB_MIN_ALPHA)), max(m.alpha_v, F(KB_MIN_ALPHA)),
          has_bits(m.flags, KB_MATERIAL_GGX), has_bits(m.flags, KB_MATERIAL_SAMPLE_VISIBLE)};
}

/// Density of normals per solid angle and projected area:
/// the integral of D(m) m.z over the hemisphere is 1.
KB_INLINE F facet_density(const Facets& facets, V3 m, M active) {
  const M up = m.z > F(1e-6f);
  const F x = m.x / facets.alpha_u, y = m.y / facets.alpha_v, z2 = m.z * m.z;
  const F slope2 = x * x + y * y;
  const F scale = F(KB_PI) * facets.alpha_u * facets.alpha_v;
  F density(0);
  if (any(active & up & facets.ggx)) {
    const F t = slope2 + z2;
    density = F(1) / (scale * t * t);
  }
  if (any(active & up & !facets.ggx)) {
    const F beckmann = exp(-slope2 / z2) / (scale * z2 * z2);
    density = select(facets.ggx, density, beckmann);
  }
  return select(up, density, F(0));
}

/// Smith's masking G1(v) / v.z. Stays finite at grazing angles, where G1 vanishes with v.z.
KB_INLINE F facet_masking_over_cos(const Facets& facets, V3 v, M active) {
  const F x = facets.alpha_u * v.x, y = facets.alpha_v * v.y;
  const F xy2 = x * x + y * y;
  F masking(0);
  if (any(active & facets.ggx)) masking = F(2) / (v.z + sqrt(v.z * v.z + xy2));
  if (any(active & !facets.ggx)) {
    // G1 = 2 / (1 + erf(a) + exp(-a^2) / (a sqrt(pi))), a = 1 / (alpha tan theta); 1 - G1 < 1e-9 for a > 4
    const F root = sqrt(xy2);
    const M far = v.z > F(4) * root;
    F beckmann = F(1) / v.z;
    if (any(active & !facets.ggx & !far)) {
      const F a = v.z / root;
      const F near = F(2) / (v.z * (F(1) + erf_positive(a)) + root * F(kInvSqrtPi) * exp(-a * a));
      beckmann = select(far, beckmann, near);
    }
    masking = select(facets.ggx, masking, beckmann);
  }
  return masking;
}

KB_INLINE F facet_masking(const Facets& facets, V3 v, M active) {
  return min(facet_masking_over_cos(facets, v, active) * v.z, F(1));
}

/// Slope towards the viewer of a visible Beckmann normal for alpha = 1 and a view at angle theta,
/// cot = cos / sin. Slopes s < cot are visible with density ~ (cos - s sin) exp(-s^2). In b = erf(s) the
/// distribution function times its norm is
///   c(b) = cos (1 + b) + sin exp(-s^2) / sqrt(pi),  c'(b) = cos - s sin >= 0;
/// c(b) = u norm is solved by Newton's method, kept inside a bracket that shrinks by
/// at least half whenever a step leaves it. Lanes that are there wait for the others.
KB_INLINE F visible_beckmann_slope(F cos_theta, F sin_theta, F u, M active) {
  const F cot = cos_theta / sin_theta;  // infinite at normal incidence, which is fine
  const F k = sin_theta * F(kInvSqrtPi);
  const F last = erf_positive(cot);
  const F target = u * (cos_theta * (F(1) + last) + k * exp(-cot * cot));
  F low(-1), high = last;
  // Between the solutions for theta = pi/2 (s = -sqrt(-log u)) and theta = 0 (b = 2 u - 1).
  const F grazing = -erf_positive(sqrt(-log(max(u, F(1e-30f)))));
  F b = min(high, max(low, grazing + (F(2) * u - F(1) - grazing) * cos_theta));
  F s(0);
  for (int i = 0; i < 12 && any(active); ++i) {
    s = select(active, erf_inverse(b), s);
    const F excess = cos_theta * (F(1) + b) + k * exp(-s * s) - target;
    const M above = excess > F(0);
    high = select(active & above, b, high);
    low = select(active & !above, b, low);
    active = active & !(abs(excess) < F(5e-7f));  // the norm is between 0.56 and 2
    const F slope = cos_theta - s * sin_theta;
    const F next = b - excess / slope;
    const M inside = (next > low) & (next < high);  // not where slope == 0
    b = select(active, select(inside, next, F(0.5f) * (low + high)), b);
  }
  if (any(active)) s = select(active, erf_inverse(b), s);
  return min(s, cot);
}

KB_INLINE V3 sample_visible_beckmann(const Facets& facets, V3 wi, V2 u, M active) {
  const V3 v = normalize({facets.alpha_u * wi.x, facets.alpha_v * wi.y, wi.z});
  const F sin_theta = sqrt(v.x * v.x + v.y * v.y);
  const M tilted = sin_theta > F(0);
  const F axis_x = select(tilted, v.x / sin_theta, F(1)), axis_y = select(tilted, v.y / sin_theta, F(0));
  const F along = visible_beckmann_slope(v.z, sin_theta, u.x, active);
  const F across = erf_inverse(F(2) * u.y - F(1));
  const F slope_x = axis_x * along - axis_y * across, slope_y = axis_y * along + axis_x * across;
  return normalize({-slope_x * facets.alpha_u, -slope_y * facets.alpha_v, F(1)});
}

/// The cap of the unit sphere around the stretched view direction, shifted by it, gives visible GGX normals.
/// Its lower part is cut at z = -v.z; h.z = (1 - u)(1 + v.z) is formed directly, so that nothing cancels.
KB_INLINE V3 sample_visible_ggx(const Facets& facets, V3 wi, V2 u) {
  const V3 v = normalize({facets.alpha_u * wi.x, facets.alpha_v * wi.y, wi.z});
  const SinCos azimuth = sin_cos_of_turns(u.y);
  const F height = (F(1) - u.x) * (F(1) + v.z);
  const F z = height - v.z;
  const F r = sqrt(max((F(1) - z) * (F(1) + z), F(0)));
  const F x = r * azimuth.cos + v.x, y = r * azimuth.sin + v.y;
  return normalize({x * facets.alpha_u, y * facets.alpha_v, height});
}

/// Slopes (alpha_u r cos phi, alpha_v r sin phi); r^2 has distribution 1 - exp(-r^2),
/// or r^2 / (1 + r^2) for GGX.
KB_INLINE V3 sample_any_normal(const Facets& facets, V2 u, M active) {
  const F rest = max(F(1) - u.x, F(1 - KB_ONE_MINUS_EPSILON));
  F r2 = u.x / rest;
  if (any(active & !facets.ggx)) r2 = select(facets.ggx, r2, -log(rest));
  const F r = sqrt(r2);
  const SinCos azimuth = sin_cos_of_turns(u.y);
  return normalize({facets.alpha_u * r * azimuth.cos, facets.alpha_v * r * azimuth.sin, F(1)});
}

/// A unit normal with m.z >= 0; u uniform in [0,1)^2.
KB_INLINE V3 sample_facet_normal(const Facets& facets, V3 wi, V2 u, M active) {
  const M ggx = active & facets.visible & facets.ggx;
  const M beckmann = active & facets.visible & !facets.ggx;
  const M all_normals = active & !facets.visible;
  V3 m{F(0), F(0), F(1)};
  if (any(ggx)) m = select(ggx, sample_visible_ggx(facets, wi, u), m);
  if (any(beckmann)) m = select(beckmann, sample_visible_beckmann(facets, wi, u, beckmann), m);
  if (any(all_normals)) m = select(all_normals, sample_any_normal(facets, u, all_normals), m);
  return m;
}

/// A reflection by microfacets: half vector and what both conductor and plastic need of it.
struct FacetReflection {
  F dot_ih;  // = dot(wo, h) = |wi + wo| / 2; 0: no half vector
  F value;   // D G / (4 cos_i), i.e. f cos_o for F = 1
  F pdf;     // of sampling wo through a normal [1/sr]
};

KB_INLINE FacetReflection facet_reflection(const Facets& facets, V3 wi, V3 wo, M active) {
  const V3 sum = wi + wo;
  const F size = length(sum);
  const M has_half = size > F(1e-10f);
  const V3 h = sum / size;
  const F dot_ih = min(F(0.5f) * size, F(1));
  const M needed = active & has_half;
  const F density = facet_density(facets, h, needed);
  const F incident = facet_masking_over_cos(facets, wi, needed);
  const F value = F(0.25f) * density * incident * facet_masking(facets, wo, needed);
  const F pdf = F(0.25f) * density * select(facets.visible, incident, h.z / dot_ih);
  return {select(has_half, dot_ih, F(0)), select(has_half, value, F(0)), select(has_half, pdf, F(0))};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
