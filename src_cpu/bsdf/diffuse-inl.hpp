// The diffuse material. wi.z > 0.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_DIFFUSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_DIFFUSE_INL
#undef KILOBAND_BSDF_DIFFUSE_INL
#else
#define KILOBAND_BSDF_DIFFUSE_INL
#endif

#include "src_cpu/bsdf/common-inl.hpp"
#include "src_cpu/lanes/lane_sampler-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

KB_INLINE BsdfValue eval_diffuse(V3 wo) {
  const F lambert = wo.z * F(KB_INV_PI);
  return {lambert, F(0), lambert, no_lanes()};
}

/// f cos / p = 1 times the reflectance, since p = cos / pi.
KB_INLINE BsdfSample sample_diffuse(const Material& material, V2 u) {
  BsdfSample sample = no_sample();
  sample.wo = cosine_hemisphere(u.x, u.y);
  sample.pdf = sample.wo.z * F(KB_INV_PI);
  sample.w0 = F(1);
  sample.bound = material.bound_a;
  return sample;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
