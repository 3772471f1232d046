// Metals. Fresnel's factor depends on wavelength: evaluation applies it at the cosine w1.
#include "src_cpu/bsdf/fresnel.hpp"
#include "src_cpu/bsdf/lobes.hpp"

namespace kiloband::cpu::lobes {

BsdfSample sample_conductor(const KbMaterial& material, glm::vec3 wi) {
  BsdfSample sample;
  sample.wo = mirror(wi);
  sample.kind = eval_kind(material);
  sample.w0 = 1;
  sample.w1 = sample.kind == KB_KIND_CONDUCTOR ? wi.z : 0;
  sample.pdf = 1;
  sample.bound = material.bound_a;  // F <= 1
  sample.delta = true;
  return sample;
}

/// f cos_o = F(wi.h) D(h) G1(wi) G1(wo) / (4 cos_i)   (Torrance-Sparrow)
BsdfValue eval_rough_conductor(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo) {
  const FacetReflection r = facet_reflection(FacetDistribution(material), wi, wo);
  const bool mirror = material.flags & KB_MATERIAL_PERFECT_MIRROR;
  return {r.value, mirror ? 0 : r.dot_ih, r.pdf, false};
}

BsdfSample sample_rough_conductor(const KbMaterial& material, glm::vec3 wi, glm::vec2 u) {
  BsdfSample sample;
  sample.wo = glm::normalize(reflect_at(wi, FacetDistribution(material).sample_normal(wi, u)));
  if (!(sample.wo.z > 0)) return sample;  // single scattering: light below the horizon is lost
  const BsdfValue value = eval_rough_conductor(material, wi, sample.wo);
  if (!(value.pdf > 0)) return sample;
  sample.kind = eval_kind(material);
  sample.w0 = value.w0 / value.pdf;
  sample.w1 = value.w1;
  sample.pdf = value.pdf;
  sample.bound = sample.w0 * material.bound_a;
  return sample;
}

}  // namespace kiloband::cpu::lobes
