// Fresnel's formulas and Snell's law for a boundary between two dielectrics.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_FRESNEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_FRESNEL_INL
#undef KILOBAND_BSDF_FRESNEL_INL
#else
#define KILOBAND_BSDF_FRESNEL_INL
#endif

#include "src_cpu/lanes/vector3-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

struct DielectricFresnel {
  F reflectance;  // unpolarised
  F cos_t;        // cosine of the refracted direction, >= 0; 0 on total internal reflection
};

/// cos_i  in [0, 1], on the incident side
/// eta    transmitted over incident index, > 0
/// The cosine is formed as (eta^2 - 1 + cos_i^2) / eta^2 with eta^2 - 1 = (eta - 1)(eta + 1): nothing
/// cancels for eta >= 1.
KB_INLINE DielectricFresnel fresnel_dielectric(F cos_i, F eta) {
  const M matched = eta == F(1);
  const F square = (eta - F(1)) * (eta + F(1)) + cos_i * cos_i;
  const M passes = square > F(0);
  const F cos_t = min(sqrt(max(square, F(0))) / eta, F(1));
  const F s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const F p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const F reflectance = min(F(0.5f) * (s * s + p * p), F(1));
  return {select(matched, F(0), select(passes, reflectance, F(1))),
          select(matched, cos_i, select(passes, cos_t, F(0)))};
}

/// wi mirrored at the microfacet normal m
KB_INLINE V3 reflect_at(V3 wi, V3 m) {
  return m * (F(2) * dot(wi, m)) - wi;
}

/// wi refracted at m; cos_t from fresnel_dielectric(dot(wi, m) > 0, eta), eta transmitted over incident
KB_INLINE V3 refract_at(V3 wi, V3 m, F cos_t, F eta) {
  return m * (dot(wi, m) / eta - cos_t) - wi / eta;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
