// Boundaries between dielectrics, smooth and rough. Here wi.z > 0; eta is the far side's index over that of
// wi's side. Transmitted radiance is scaled by 1 / eta^2, which `bound` leaves out.
#include "src_cpu/bsdf/fresnel.hpp"
#include "src_cpu/bsdf/lobes.hpp"

namespace kiloband::cpu::lobes {
namespace {

/// Delta transmission with weight `weight` before the radiance scaling.
BsdfSample refracted(const KbMaterial& material, glm::vec3 wi, float eta, float cos_t, float weight,
                     float pdf) {
  BsdfSample sample;
  sample.wo = {-wi.x / eta, -wi.y / eta, -cos_t};
  sample.w0 = weight / (eta * eta);
  sample.pdf = pdf;
  sample.eta = eta;
  sample.bound = weight * material.bound_b;
  sample.delta = sample.transmission = sample.lobe_b = true;
  return sample;
}

/// Roughness that normals are sampled with: without visible normals slightly larger, which bounds the weights
/// better (Walter et al. 2007, section 5.3).
FacetDistribution sampled_facets(const FacetDistribution& facets, float cos_i) {
  return facets.sample_visible() ? facets : facets.scaled(1.2f - 0.2f * std::sqrt(cos_i));
}

struct HalfVector {
  glm::vec3 m{0};
  float dot_i = 0, dot_o = 0;  // dot_i > 0 if valid; dot_o has the sign of wo.z
  float length = 0;            // |wi + eta wo| = |dot_i + eta dot_o|, or |wi + wo|
};

HalfVector half_vector(glm::vec3 wi, glm::vec3 wo, float eta) {
  HalfVector half;
  const glm::vec3 sum = wi + (wo.z > 0 ? 1.0f : eta) * wo;
  half.length = glm::length(sum);
  if (!(half.length > 1e-10f)) return half;
  half.m = sum / (sum.z < 0 ? -half.length : half.length);
  half.dot_i = std::min(glm::dot(wi, half.m), 1.0f);
  half.dot_o = std::max(glm::dot(wo, half.m), -1.0f);
  return half;
}

/// Delta reflection; evaluation applies a reflectance that is left out, F <= 1.
BsdfSample reflected(const KbMaterial& material, glm::vec3 wi, float weight, float pdf) {
  BsdfSample sample;
  sample.wo = mirror(wi);
  sample.w0 = weight;
  sample.pdf = pdf;
  sample.bound = weight * material.bound_a;
  sample.delta = true;
  return sample;
}

/// Of a pane whose faces reflect F: F + (1 - F)^2 F (1 + F^2 + F^4 + ...) = 2 F / (1 + F). The rest passes.
float pane_reflectance(float f) {
  return 2 * f / (1 + f);
}

/// Through a pane light goes straight on.
BsdfSample passed_pane(const KbMaterial& material, glm::vec3 wi, float weight, float pdf) {
  BsdfSample sample;
  sample.wo = -wi;
  sample.w0 = weight;
  sample.pdf = pdf;
  sample.bound = weight * material.bound_b;
  sample.delta = sample.transmission = sample.lobe_b = true;
  return sample;
}

}  // namespace

/// Reflection with probability F: both weights are then 1 (times the radiance scaling).
BsdfSample sample_dielectric(const KbMaterial& material, glm::vec3 wi, float eta, float u_lobe) {
  const DielectricFresnel f = fresnel_dielectric(std::min(wi.z, 1.0f), eta);
  if (material.flags & KB_MATERIAL_THIN) {
    const float p = pane_reflectance(f.reflectance);
    return u_lobe < p ? reflected(material, wi, 1, p) : passed_pane(material, wi, 1, 1 - p);
  }
  if (u_lobe >= f.reflectance) return refracted(material, wi, eta, f.cos_t, 1, 1 - f.reflectance);
  return reflected(material, wi, 1, f.reflectance);
}

/// All channels are reflected into one direction, so reflection is chosen by the guide mean's F, kept within
/// [0.1, 0.9] since single channels may reflect where the mean does not (and the other way round); evaluation
/// applies F per channel.
BsdfSample sample_dispersive(const KbMaterial& material, glm::vec3 wi, float eta, bool below, float u_lobe) {
  const bool thin = material.flags & KB_MATERIAL_THIN;
  const float f = fresnel_dielectric(std::min(wi.z, 1.0f), eta).reflectance;
  const float p = std::clamp(thin ? pane_reflectance(f) : f, 0.1f, 0.9f);
  BsdfSample sample;
  if (u_lobe < p) {
    sample = reflected(material, wi, 1 / p, p);
    sample.kind = KB_KIND_DISPERSIVE;
    sample.w1 = below && !thin ? -wi.z : wi.z;
  } else if (thin) {  // all channels go straight on: none need be chosen
    sample = passed_pane(material, wi, 1 / (1 - p), 1 - p);
    sample.kind = KB_KIND_DISPERSIVE;
    sample.w1 = -wi.z;
  } else {
    sample.pdf = 1 - p;
    sample.delta = sample.transmission = sample.needs_channel = true;
  }
  return sample;
}

/// Walter et al. 2007, with m the half vector of reflection or refraction and J = |dm / dwo|:
///   f cos_o = F D G1(wi) G1(wo) / (4 cos_i)                                                    reflection
///   f cos_o = (1 - F) D G1(wi) G1(wo) |wi.m| |wo.m| / (cos_i (wi.m + eta wo.m)^2)              transmission,
/// the latter with the 1 / eta^2 of radiance included. pdf = {F, 1 - F} p(m) J, J = 1 / (4 |wo.m|) for
/// reflection and eta^2 |wo.m| / (wi.m + eta wo.m)^2 for transmission.
BsdfValue eval_rough_dielectric(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo, float eta) {
  const FacetDistribution facets(material);
  if (acts_smooth(facets, eta)) return {};
  const HalfVector half = half_vector(wi, wo, eta);
  if (!(half.dot_i > 0) || !(half.dot_o * wo.z > 0)) return {};
  const float f = fresnel_dielectric(half.dot_i, eta).reflectance;
  const glm::vec3 up(wo.x, wo.y, std::abs(wo.z));
  const float density = facets.normal_density(half.m);
  const float common = density * facets.masking_over_cos(wi) * facets.masking(up);
  float pdf = density;
  if (!facets.sample_visible()) pdf = sampled_facets(facets, wi.z).normal_density(half.m);
  pdf = facets.normal_pdf(wi, half.m, pdf, half.dot_i);
  if (wo.z > 0) return {0.25f * f * common, 0, f * pdf / (4 * half.dot_o), false};
  const float jacobian = -half.dot_o / (half.length * half.length);
  return {(1 - f) * common * half.dot_i * jacobian, 0, (1 - f) * pdf * eta * eta * jacobian, true};
}

BsdfSample sample_rough_dielectric(const KbMaterial& material, glm::vec3 wi, float eta, float u_lobe,
                                   glm::vec2 u) {
  const FacetDistribution facets(material);
  if (acts_smooth(facets, eta)) return sample_dielectric(material, wi, eta, u_lobe);
  BsdfSample sample;
  const glm::vec3 m = sampled_facets(facets, wi.z).sample_normal(wi, u);
  const float dot_i = glm::dot(wi, m);
  if (!(dot_i > 0)) return sample;  // a normal that wi cannot see (not visible-normal sampling)
  const DielectricFresnel f = fresnel_dielectric(std::min(dot_i, 1.0f), eta);
  const bool reflect = u_lobe < f.reflectance;
  sample.wo = glm::normalize(reflect ? reflect_at(wi, m) : refract_at(wi, m, f.cos_t, eta));
  if (!(reflect ? sample.wo.z > 0 : sample.wo.z < 0)) return sample;  // lost: it would scatter again
  const BsdfValue value = eval_rough_dielectric(material, wi, sample.wo, eta);
  if (!(value.pdf > 0)) return sample;
  sample.w0 = value.w0 / value.pdf;
  sample.pdf = value.pdf;
  sample.eta = reflect ? 1 : eta;
  sample.bound = sample.w0 * sample.eta * sample.eta * (reflect ? material.bound_a : material.bound_b);
  sample.transmission = sample.lobe_b = !reflect;
  return sample;
}

}  // namespace kiloband::cpu::lobes

namespace kiloband::cpu {

bool acts_smooth(const KbMaterial& material, float eta) {
  return lobes::acts_smooth(FacetDistribution(material), eta);
}

BoundaryPair rough_boundary_pair(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo) {
  BoundaryPair pair;
  if (wi.z == 0 || wo.z == 0) return pair;
  const bool below = wi.z < 0;
  if (below) wi.z = -wi.z, wo.z = -wo.z;
  const FacetDistribution facets(material);
  const float masking = facets.masking_over_cos(wi) * facets.masking({wo.x, wo.y, std::abs(wo.z)});
  pair.transmission = wo.z < 0;
  if (pair.transmission) {
    pair.weight = masking;
    return pair;
  }
  const lobes::HalfVector half = lobes::half_vector(wi, wo, 1);
  if (!(half.dot_i > 0) || !(half.dot_o > 0)) return pair;
  pair.weight = 0.25f * facets.normal_density(half.m) * masking;
  pair.cosine = below ? -half.dot_i : half.dot_i;
  return pair;
}

BsdfSample transmit_dispersive(const KbMaterial& material, glm::vec3 wi, float eta_channel,
                               float probability) {
  if (!(std::abs(wi.z) > 0) || !(eta_channel > 0) || !(probability > 0)) return {};
  const bool below = wi.z < 0;
  const float eta = below ? 1 / eta_channel : eta_channel;
  if (below) wi.z = -wi.z;
  const DielectricFresnel f = fresnel_dielectric(std::min(wi.z, 1.0f), eta);
  if (!(f.reflectance < 1)) return {};
  BsdfSample sample =
      lobes::refracted(material, wi, eta, f.cos_t, (1 - f.reflectance) / probability, probability);
  if (below) sample.wo.z = -sample.wo.z;
  return sample;
}

}  // namespace kiloband::cpu
