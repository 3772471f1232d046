// Chooses the material's functions; the diffuse model itself is here.
#include <stdexcept>

#include "shared/estimator.h"
#include "shared/thermal.h"
#include "src_cpu/bsdf/bsdf.hpp"
#include "src_cpu/bsdf/lobes.hpp"

namespace kiloband::cpu {
namespace {

glm::vec3 flip(glm::vec3 w) {
  return {w.x, w.y, -w.z};
}

bool not_degraded(const MaterialContext& context) {
  return (context.material->flags & KB_MATERIAL_DISPERSIVE) && !(context.dispersion.eta > 0);
}

/// Interior over exterior index of a dielectric.
float index_ratio(const MaterialContext& context) {
  const KbMaterial& m = *context.material;
  return m.flags & KB_MATERIAL_DISPERSIVE && context.dispersion.eta > 0 ? context.dispersion.eta : m.eta;
}

const float* coat_of(const MaterialContext& context) {
  if (!context.table) throw std::logic_error("rough plastic without its transmittance table");
  return context.table;
}

BsdfValue eval_dielectric_side(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo) {
  if (not_degraded(context)) throw std::logic_error("rough dispersive dielectric that is not degraded");
  const float eta = index_ratio(context);
  if (wi.z > 0) return lobes::eval_rough_dielectric(*context.material, wi, wo, eta);
  return lobes::eval_rough_dielectric(*context.material, flip(wi), flip(wo), 1 / eta);
}

BsdfSample sample_dielectric_side(const MaterialContext& context, glm::vec3 wi, float u_lobe, glm::vec2 u) {
  const KbMaterial& material = *context.material;
  const bool rough = material.type == KB_MATERIAL_ROUGH_DIELECTRIC;
  if (rough && not_degraded(context))
    throw std::logic_error("rough dispersive dielectric that is not degraded");
  const bool below = wi.z < 0;
  const bool inside = below && !(material.flags & KB_MATERIAL_THIN);
  const float eta = inside ? 1 / index_ratio(context) : index_ratio(context);
  if (below) wi = flip(wi);
  BsdfSample sample = rough                   ? lobes::sample_rough_dielectric(material, wi, eta, u_lobe, u)
                      : not_degraded(context) ? lobes::sample_dispersive(material, wi, eta, below, u_lobe)
                                              : lobes::sample_dielectric(material, wi, eta, u_lobe);
  if (below) sample.wo = flip(sample.wo);
  return sample;
}

}  // namespace

namespace {

/// A place between the nodes of a table.
struct TablePlace {
  int node;
  float t;
};
TablePlace table_place(float position, int nodes) {
  const float x = std::clamp(position, 0.0f, static_cast<float>(nodes - 1));
  const int node = std::min(static_cast<int>(x), nodes - 2);
  return {node, x - static_cast<float>(node)};
}

}  // namespace

float lobe_albedo(const MaterialContext& context, glm::vec3 wi) {
  const KbMaterial& m = *context.material;
  const float alpha_u = std::max(m.alpha_u, KB_MIN_ALPHA), alpha_v = std::max(m.alpha_v, KB_MIN_ALPHA);
  const float root = std::sqrt(alpha_u * alpha_u * wi.x * wi.x + alpha_v * alpha_v * wi.y * wi.y);
  const float cosine = std::abs(wi.z);
  const int nodes_s = static_cast<int>(context.compensation[0]),
            nodes_eta = static_cast<int>(context.compensation[1]);
  const TablePlace x =
      table_place(cosine / (cosine + root) * (KB_COMPENSATION_NODES - 1), KB_COMPENSATION_NODES);
  TablePlace s{0, 0};
  if (nodes_s > 1) {
    const bool glass = m.type == KB_MATERIAL_ROUGH_DIELECTRIC;
    const float px = (glass ? std::sqrt(std::sqrt(alpha_u)) : alpha_u) * wi.x;
    const float py = (glass ? std::sqrt(std::sqrt(alpha_v)) : alpha_v) * wi.y;
    const float sum = px * px + py * py;
    s = table_place((sum > 0 ? py * py / sum : 0) * static_cast<float>(nodes_s - 1), nodes_s);
  }
  TablePlace eta{0, 0};
  if (nodes_eta > 1)
    eta = table_place((index_ratio(context) - context.compensation[2]) * context.compensation[3], nodes_eta);
  const bool inside = m.type == KB_MATERIAL_ROUGH_DIELECTRIC && wi.z < 0;
  const float* table = context.compensation + KB_COMPENSATION_HEADER +
                       (inside ? nodes_eta : 0) * nodes_s * KB_COMPENSATION_NODES;
  const auto row = [&](int j, int i) {
    const float* node = table + ((eta.node + i) * nodes_s + s.node + j) * KB_COMPENSATION_NODES + x.node;
    return node[0] + x.t * (node[1] - node[0]);
  };
  const auto plane = [&](int i) {
    const float low = row(0, i);
    return s.t > 0 ? low + s.t * (row(1, i) - low) : low;
  };
  const float low = plane(0);
  return eta.t > 0 ? low + eta.t * (plane(1) - low) : low;
}

/// Both triangles of the map without a branch: the larger coordinate is the radius, the angle is at most
/// pi/4, where Taylor polynomials reach float precision.
/// Signs and magnitudes agree with shared/warp.h to rounding.
glm::vec3 lobes::cosine_direction(glm::vec2 u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  const float larger = std::max(std::abs(a), std::abs(b)), smaller = std::min(std::abs(a), std::abs(b));
  const float phi = (KB_PI / 4) * (smaller / std::max(larger, 1e-30f));
  const float p2 = phi * phi;
  const float s = phi * (1 + p2 * (-1 / 6.0f + p2 * (1 / 120.0f + p2 * (-1 / 5040.0f + p2 / 362880.0f))));
  const float c = 1 + p2 * (-0.5f + p2 * (1 / 24.0f + p2 * (-1 / 720.0f + p2 / 40320.0f)));
  const float along = larger * c, across = larger * s;
  const uint32_t wide = std::abs(a) > std::abs(b) ? 0xffffffffu : 0u;
  const uint32_t x = (kb_as_u32(along) & wide) | (kb_as_u32(across) & ~wide);
  const uint32_t y = (kb_as_u32(across) & wide) | (kb_as_u32(along) & ~wide);
  return {std::copysign(kb_as_f32(x), a), std::copysign(kb_as_f32(y), b),
          std::sqrt(std::max(1e-12f, 1 - larger * larger))};
}

/// f cos / p = 1 times the reflectance, since p = cos / pi.
BsdfSample lobes::sample_diffuse(const KbMaterial& material, glm::vec2 u) {
  BsdfSample sample;
  sample.wo = cosine_direction(u);
  sample.pdf = sample.wo.z * KB_INV_PI;
  sample.w0 = 1;
  sample.bound = material.bound_a;
  return sample;
}

static BsdfValue eval_uncompensated(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo) {
  const KbMaterial& material = *context.material;
  if (material.type == KB_MATERIAL_ROUGH_DIELECTRIC)
    return wi.z != 0 && wo.z != 0 ? eval_dielectric_side(context, wi, wo) : BsdfValue{};
  if (!(wi.z > 0) || !(wo.z > 0)) return {};
  switch (material.type) {
    case KB_MATERIAL_DIFFUSE:
      return {wo.z * KB_INV_PI, 0, wo.z * KB_INV_PI, false};
    case KB_MATERIAL_ROUGH_CONDUCTOR:
      return lobes::eval_rough_conductor(material, wi, wo);
    case KB_MATERIAL_PLASTIC:
      return lobes::eval_plastic(material, wi, wo);
    case KB_MATERIAL_ROUGH_PLASTIC:
      return lobes::eval_rough_plastic(material, coat_of(context), wi, wo);
    default:
      return {};
  }
}

static BsdfSample sample_uncompensated(const MaterialContext& context, glm::vec3 wi, float u_lobe,
                                       glm::vec2 u) {
  const KbMaterial& material = *context.material;
  if (material.type == KB_MATERIAL_DIELECTRIC || material.type == KB_MATERIAL_ROUGH_DIELECTRIC)
    return wi.z > 0 || wi.z < 0 ? sample_dielectric_side(context, wi, u_lobe, u) : BsdfSample{};
  if (!(wi.z > 0)) return {};
  switch (material.type) {
    case KB_MATERIAL_DIFFUSE:
      return lobes::sample_diffuse(material, u);
    case KB_MATERIAL_CONDUCTOR:
      return lobes::sample_conductor(material, wi);
    case KB_MATERIAL_ROUGH_CONDUCTOR:
      return lobes::sample_rough_conductor(material, wi, u);
    case KB_MATERIAL_PLASTIC:
      return lobes::sample_plastic(material, wi, u_lobe, u);
    case KB_MATERIAL_ROUGH_PLASTIC:
      return lobes::sample_rough_plastic(material, coat_of(context), wi, u_lobe, u);
    default:
      return {};
  }
}

/// Of conductors w0, of the specular lobe of plastics w0, of either lobe of dielectrics.
BsdfValue eval_bsdf(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo) {
  BsdfValue value = eval_uncompensated(context, wi, wo);
  if (context.compensation) value.w0 /= lobe_albedo(context, wi);
  return value;
}

BsdfSample sample_bsdf(const MaterialContext& context, glm::vec3 wi, float u_lobe, glm::vec2 u) {
  BsdfSample sample = sample_uncompensated(context, wi, u_lobe, u);
  if (!context.compensation || sample.delta || !(sample.pdf > 0)) return sample;
  const float gain = 1 / lobe_albedo(context, wi);
  const KbMaterial& material = *context.material;
  if (material.type == KB_MATERIAL_ROUGH_PLASTIC) {
    sample.bound += sample.w0 * (gain - 1) * material.bound_a;
  } else {
    sample.bound *= gain;
  }
  sample.w0 *= gain;
  return sample;
}

}  // namespace kiloband::cpu
