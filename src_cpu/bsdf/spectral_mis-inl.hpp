// The BSDF of a rough dispersive boundary for all heroes of a path: a lane is a hero.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_SPECTRAL_MIS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_SPECTRAL_MIS_INL
#undef KILOBAND_SPECTRAL_MIS_INL
#else
#define KILOBAND_SPECTRAL_MIS_INL
#endif

#include <algorithm>

#include "src_cpu/bsdf/bsdf-inl.hpp"
#include "src_cpu/bsdf/spectral_mis.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// EvalHeroes
inline void eval_heroes(const KbMaterial& material, const HeroSet& heroes, glm::vec3 wi, glm::vec3 wo,
                        HeroValues& values) {
  Material m = one_material(material);
  const V3 from{wi.x, wi.y, wi.z}, to{wo.x, wo.y, wo.z};
  for (uint32_t first = 0; first < heroes.count; first += kLanes) {
    const uint32_t lanes = std::min(kLanes, heroes.count - first);
    FloatArray eta(F(1));
    std::copy_n(&heroes.eta[first], lanes, eta.at);
    m.channel_eta = eta;
    BsdfValue value = no_value();
    const M active = first_lanes(lanes) & (abs(from.z) > F(0)) & (abs(to.z) > F(0));
    if (any(active)) eval_dielectric_side(m, from, to, active, value);
    std::copy_n(FloatArray(value.w0).at, lanes, &values.w0[first]);
    std::copy_n(FloatArray(value.pdf).at, lanes, &values.pdf[first]);
  }
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
