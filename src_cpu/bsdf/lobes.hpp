// One function per material and operation; bsdf_dispatch.cpp chooses. Included by the bsdf_*.cpp files only.
//
// Functions named eval_* take directions that the material can scatter between: reflecting models wi.z > 0
// and wo.z > 0, dielectrics wi.z > 0 and wo.z != 0 with `eta` the far side's index over that of wi's side
// (dispatch mirrors what comes from below: distributions of normals are symmetric). sample_* take wi.z > 0.
#pragma once

#include <glm/glm.hpp>

#include "shared/records.h"
#include "src_cpu/bsdf/bsdf.hpp"
#include "src_cpu/bsdf/microfacet.hpp"

namespace kiloband::cpu::lobes {

inline glm::vec3 mirror(glm::vec3 w) {
  return {-w.x, -w.y, w.z};
}

/// Cosine-weighted direction by Shirley and Chiu's concentric map of the square
/// to the disk; density cos / pi.
glm::vec3 cosine_direction(glm::vec2 u);

BsdfSample sample_diffuse(const KbMaterial& material, glm::vec2 u);

BsdfSample sample_conductor(const KbMaterial& material, glm::vec3 wi);
BsdfValue eval_rough_conductor(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo);
BsdfSample sample_rough_conductor(const KbMaterial& material, glm::vec3 wi, glm::vec2 u);

BsdfSample sample_dielectric(const KbMaterial& material, glm::vec3 wi, float eta, float u_lobe);
/// Before degradation; `below` says that wi was mirrored.
BsdfSample sample_dispersive(const KbMaterial& material, glm::vec3 wi, float eta, bool below, float u_lobe);
/// Is the boundary's lobe too narrow for float directions, so that it is treated as smooth?
inline bool acts_smooth(const FacetDistribution& facets, float eta) {
  return facets.min_alpha() * std::abs(eta - 1) < 3e-6f;
}
BsdfValue eval_rough_dielectric(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo, float eta);
BsdfSample sample_rough_dielectric(const KbMaterial& material, glm::vec3 wi, float eta, float u_lobe,
                                   glm::vec2 u);

BsdfValue eval_plastic(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo);
BsdfSample sample_plastic(const KbMaterial& material, glm::vec3 wi, float u_lobe, glm::vec2 u);
BsdfValue eval_rough_plastic(const KbMaterial& material, const float* coat, glm::vec3 wi, glm::vec3 wo);
BsdfSample sample_rough_plastic(const KbMaterial& material, const float* coat, glm::vec3 wi, float u_lobe,
                                glm::vec2 u);

/// A reflection by microfacets: half vector and what both conductor and plastic need of it.
struct FacetReflection {
  glm::vec3 h{0};
  float dot_ih = 0;  // = dot(wo, h) = |wi + wo| / 2; 0: no half vector
  float value = 0;   // D G / (4 cos_i), i.e. f cos_o for F = 1
  float pdf = 0;     // of sampling wo through a normal [1/sr]
};

inline FacetReflection facet_reflection(const FacetDistribution& facets, glm::vec3 wi, glm::vec3 wo) {
  FacetReflection r;
  const glm::vec3 sum = wi + wo;
  const float length = glm::length(sum);
  if (!(length > 1e-10f)) return r;
  r.h = sum / length;
  r.dot_ih = std::min(0.5f * length, 1.0f);
  const float density = facets.normal_density(r.h);
  const float incident = facets.masking_over_cos(wi);
  r.value = 0.25f * density * incident * facets.masking(wo);
  r.pdf = 0.25f * density * (facets.sample_visible() ? incident : r.h.z / r.dot_ih);
  return r;
}

}  // namespace kiloband::cpu::lobes
