// Spectral multiple importance sampling at rough boundaries whose index depends on wavelength.
//
// Where the direction would be sampled for one channel alone, the others would have to stop (degradation).
// Instead C hero channels stand for all (Wilkie et al. 2014, "Hero wavelength spectral sampling"): they are
// spread evenly over the K channels with an offset xi per path, the direction at boundary v is sampled for
// one of them, and every channel k goes on with f_k over the density of all C choices together,
//   p(x_1 ... x_n) = 1/C sum_c prod_v p'_c(x_v),   p'_c = (1 - delta) p_c + delta |cos theta| / (2 pi),
// the balance heuristic over the heroes. As conditional densities: with q_c the probability that the path so
// far was sampled for hero c (uniform at first), hero c is chosen with probability q_c, the direction has the
// density p = sum_c q_c p'_c, and then q_c <- q_c p'_c / p. The small part delta of directions that belong to
// no hero covers what no hero's lobe reaches, so the estimator is unbiased for every channel and any xi.
// After all, evaluation needs no density: f_k / p is a weight times the factor T of the channel.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "shared/estimator.h"
#include "shared/records.h"

namespace kiloband::cpu {

/// Hero c of a path: a channel index in [0, channels). offset: xi in [0, 1).
uint32_t hero_channel(uint32_t c, uint32_t heroes, uint32_t channels, float offset);

/// The heroes at one boundary.
struct HeroSet {
  uint32_t count = 0;                      // C = min(K, KB_MAX_HEROES)
  std::array<float, KB_MAX_HEROES> eta{};  // interior over exterior index of each
  std::array<float, KB_MAX_HEROES> q{};    // sums to 1
};

/// BSDF values of a pair of directions by heroes: f_c |cos theta_o| without spectral factors, and p_c [1/sr].
struct HeroValues {
  std::array<float, KB_MAX_HEROES> w0{}, pdf{};
};
/// Of a rough dispersive boundary with each hero's index: PathKernels::eval_heroes.
using EvalHeroes = void (*)(const KbMaterial& material, const HeroSet& heroes, glm::vec3 wi, glm::vec3 wo,
                            HeroValues& values);

/// A direction as the heroes see it.
struct HeroDensity {
  float pdf = 0;    // p [1/sr]
  float value = 0;  // largest f_c |cos theta_o| over the heroes, without spectral factors [1/sr]
  float bound = 0;  // the same without the radiance scaling of transmission
  std::array<float, KB_MAX_HEROES> hero{};  // p'_c
};
HeroDensity hero_density(EvalHeroes eval, const KbMaterial& material, const HeroSet& heroes, glm::vec3 wi,
                         glm::vec3 wo);

/// A direction of density p; 0 where the sampled facet loses it. u_hero: .x chooses the hero, .y whether any.
glm::vec3 sample_heroes(const KbMaterial& material, const HeroSet& heroes, glm::vec3 wi, glm::vec2 u_hero,
                        float u_lobe, glm::vec2 u);

}  // namespace kiloband::cpu
