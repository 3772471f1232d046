#include "src_cpu/bsdf/spectral_mis.hpp"

#include <algorithm>
#include <cmath>

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/bsdf/bsdf-inl.hpp"

namespace kiloband::cpu {

uint32_t hero_channel(uint32_t c, uint32_t heroes, uint32_t channels, float offset) {
  const float position = (static_cast<float>(c) + offset) / static_cast<float>(heroes);
  return std::min(static_cast<uint32_t>(position * static_cast<float>(channels)), channels - 1);
}

HeroDensity hero_density(EvalHeroes eval, const KbMaterial& material, const HeroSet& heroes, glm::vec3 wi,
                         glm::vec3 wo) {
  HeroDensity density;
  HeroValues values;
  eval(material, heroes, wi, wo, values);
  const float even = KB_NO_HERO * std::abs(wo.z) * (0.5f * KB_INV_PI);
  const bool transmission = wi.z * wo.z < 0;
  for (uint32_t c = 0; c < heroes.count; ++c) {
    const float eta = wi.z < 0 ? 1 / heroes.eta[c] : heroes.eta[c], w0 = values.w0[c];
    density.hero[c] = (1 - KB_NO_HERO) * values.pdf[c] + even;
    density.pdf += heroes.q[c] * density.hero[c];
    density.value = std::max(density.value, w0);
    density.bound = std::max(density.bound, transmission ? w0 * eta * eta : w0);
  }
  return density;
}

glm::vec3 sample_heroes(const KbMaterial& material, const HeroSet& heroes, glm::vec3 wi, glm::vec2 u_hero,
                        float u_lobe, glm::vec2 u) {
  if (u_hero.y < KB_NO_HERO) {
    const glm::vec3 wo = to_glm(one_lane::cosine_hemisphere(u.x, u.y));
    return u_lobe < 0.5f ? wo : glm::vec3(wo.x, wo.y, -wo.z);
  }
  uint32_t c = 0;
  for (float sum = heroes.q[0]; c + 1 < heroes.count && u_hero.x >= sum;) sum += heroes.q[++c];
  one_lane::Material seen = one_lane::one_material(material);
  seen.type = one_lane::U(uint32_t{KB_MATERIAL_ROUGH_DIELECTRIC});  // the compiler leaves the others out
  seen.channel_eta = heroes.eta[c];
  one_lane::BsdfSample sample = one_lane::no_sample();
  if (wi.z != 0) one_lane::sample_dielectric_side(seen, to_lane(wi), u_lobe, to_lane(u), {true}, sample);
  return sample.pdf.v > 0 ? to_glm(sample.wo) : glm::vec3(0);
}

}  // namespace kiloband::cpu
