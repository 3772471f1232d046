// A diffuse base under a dielectric coating, smooth and rough (Mitsuba 3's model):
//
//   specular  F(wi) delta, or F D G / (4 cos_i)
//   diffuse   rho / (1 - rho' R_int) T(cos_i) T(cos_o) cos_o / (pi eta^2),   rho' = rho if nonlinear, else 1
//
// T = 1 - F for the smooth coating and the tabulated transmittance for the rough one. w0 goes with S_a
// (specular), w1 with S_b (diffuse); for KB_KIND_NONLINEAR the denominator is applied by evaluation.
#include "shared/estimator.h"
#include "shared/material_tables.h"
#include "src_cpu/bsdf/fresnel.hpp"
#include "src_cpu/bsdf/lobes.hpp"

namespace kiloband::cpu::lobes {
namespace {

bool is_nonlinear(const KbMaterial& material) {
  return material.flags & KB_MATERIAL_NONLINEAR;
}

/// Mitsuba's choice by reflected fraction and guide means, mixed with uniform: each lobe has at least 5 %.
float specular_probability(const KbMaterial& material, float reflectance) {
  const float s = reflectance * material.specular_weight;
  const float d = (1 - reflectance) * (1 - material.specular_weight);
  const float p = s + d > 0 ? s / (s + d) : 0.5f;
  return (1 - KB_UNIFORM_LOBES) * p + 0.5f * KB_UNIFORM_LOBES;
}

/// The diffuse term's part that depends on the material alone;
/// the denominator stays out for KB_KIND_NONLINEAR.
float diffuse_scale(const KbMaterial& material) {
  const float scale = 1 / (material.eta * material.eta);
  return is_nonlinear(material) ? scale : scale / (1 - material.fdr_int);
}

float bound_of(const KbMaterial& material, float w0, float w1) {
  const float b = material.bound_b;
  return w0 * material.bound_a + w1 * (is_nonlinear(material) ? b / (1 - b * material.fdr_int) : b);
}

BsdfSample make_sample(const KbMaterial& material, glm::vec3 wo, float w0, float w1, float pdf) {
  BsdfSample sample;
  sample.wo = wo;
  sample.kind = eval_kind(material);
  sample.w0 = w0;
  sample.w1 = w1;
  sample.pdf = pdf;
  sample.bound = bound_of(material, w0, w1);
  return sample;
}

float coating_reflectance(const KbMaterial& material, float cos_theta) {
  return fresnel_dielectric(std::min(cos_theta, 1.0f), material.eta).reflectance;
}

}  // namespace

BsdfValue eval_plastic(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo) {
  const float f_i = coating_reflectance(material, wi.z), f_o = coating_reflectance(material, wo.z);
  const float lambert = wo.z * KB_INV_PI;
  const float w1 = (1 - f_i) * (1 - f_o) * diffuse_scale(material) * lambert;
  return {0, w1, (1 - specular_probability(material, f_i)) * lambert, false};
}

BsdfSample sample_plastic(const KbMaterial& material, glm::vec3 wi, float u_lobe, glm::vec2 u) {
  const float f_i = coating_reflectance(material, wi.z);
  const float p = specular_probability(material, f_i);
  if (u_lobe < p) {
    BsdfSample sample = make_sample(material, mirror(wi), f_i / p, 0, p);
    sample.delta = true;
    return sample;
  }
  const glm::vec3 wo = cosine_direction(u);
  const float f_o = coating_reflectance(material, wo.z);
  const float w1 = (1 - f_i) * (1 - f_o) * diffuse_scale(material) / (1 - p);
  return make_sample(material, wo, 0, w1, (1 - p) * wo.z * KB_INV_PI);
}

BsdfValue eval_rough_plastic(const KbMaterial& material, const float* coat, glm::vec3 wi, glm::vec3 wo) {
  const float t_i = kb_coat_transmittance(coat, wi.z), t_o = kb_coat_transmittance(coat, wo.z);
  const float p = specular_probability(material, 1 - t_i);
  const FacetReflection r = facet_reflection(FacetDistribution(material), wi, wo);
  const float lambert = wo.z * KB_INV_PI;
  const float w1 = t_i * t_o * diffuse_scale(material) * lambert;
  return {coating_reflectance(material, r.dot_ih) * r.value, w1, p * r.pdf + (1 - p) * lambert, false};
}

/// The lobes overlap, so weights and density are those of the whole material.
BsdfSample sample_rough_plastic(const KbMaterial& material, const float* coat, glm::vec3 wi, float u_lobe,
                                glm::vec2 u) {
  const float p = specular_probability(material, 1 - kb_coat_transmittance(coat, wi.z));
  const glm::vec3 wo = u_lobe < p
                           ? glm::normalize(reflect_at(wi, FacetDistribution(material).sample_normal(wi, u)))
                           : cosine_direction(u);
  if (!(wo.z > 0)) return {};
  const BsdfValue value = eval_rough_plastic(material, coat, wi, wo);
  if (!(value.pdf > 0)) return {};
  return make_sample(material, wo, value.w0 / value.pdf, value.w1 / value.pdf, value.pdf);
}

}  // namespace kiloband::cpu::lobes
