// The BSDFs of one path at a time: those over lanes, for one lane.
#include "src_cpu/bsdf/bsdf.hpp"

#include <algorithm>
#include <stdexcept>

#include "src_cpu/lanes/one_lane.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/bsdf/bsdf-inl.hpp"

namespace kiloband::cpu {
namespace {

using one_lane::F;
using one_lane::M;
using one_lane::U;

constexpr M kActive{true};

one_lane::V3 lane_of(glm::vec3 v) {
  return {v.x, v.y, v.z};
}

/// Offsets count from the first of its tables.
one_lane::Material lane_of(const MaterialContext& context) {
  one_lane::Material m = one_lane::one_material(*context.material);
  m.tables = context.table ? context.table : context.compensation;
  if (context.table) m.table = U(0u);
  if (context.compensation) m.compensation = U(static_cast<uint32_t>(context.compensation - m.tables));
  m.channel_eta = context.dispersion.eta;
  return m;
}

BsdfSample sample_of(const one_lane::BsdfSample& s) {
  return {{s.wo.x.v, s.wo.y.v, s.wo.z.v},
          s.w0.v,
          s.w1.v,
          s.pdf.v,
          s.eta.v,
          s.bound.v,
          s.delta.v,
          s.transmission.v,
          static_cast<uint8_t>(s.kind.v),
          s.lobe_b.v,
          s.needs_channel.v};
}

void check_rough_plastic(const MaterialContext& context) {
  if (!context.table) throw std::logic_error("rough plastic without its transmittance table");
}

void check_rough_dielectric(const MaterialContext& context) {
  if ((context.material->flags & KB_MATERIAL_DISPERSIVE) && !(context.dispersion.eta > 0))
    throw std::logic_error("rough dispersive dielectric that is not degraded");
}

/// Of a type that the compiler knows: what others need is not asked for.
template <KbMaterialType Type>
KB_INLINE one_lane::Material lane_of_type(const MaterialContext& context) {
  one_lane::Material m = lane_of(context);
  m.type = U(static_cast<uint32_t>(Type));
  return m;
}

/// A principled material with its numbers.
struct PrincipledLane {
  explicit PrincipledLane(const MaterialContext& context) : material(lane_of(context)) {
    if (!context.table) throw std::logic_error("principled material without its numbers");
    for (uint32_t n = 0; n < KB_PRINCIPLED_NUMBERS; ++n) numbers.number[n] = F(context.table[n]);
    material.principled = &numbers;
    one_lane::set_principled_alpha(material, kActive);
  }
  PrincipledLane(const PrincipledLane&) = delete;
  PrincipledLane& operator=(const PrincipledLane&) = delete;

  one_lane::Material material;
  one_lane::Principled numbers;
};

BsdfValue value_of(const one_lane::BsdfValue& v) {
  return {v.w0.v, v.w1.v, v.pdf.v, v.lobe_b.v};
}

template <KbMaterialType Type>
KB_INLINE BsdfValue eval_type(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo) {
  const one_lane::Material m = lane_of_type<Type>(context);
  return value_of(one_lane::eval_bsdf(m, lane_of(wi), lane_of(wo), kActive));
}

template <KbMaterialType Type>
KB_INLINE BsdfSample sample_type(const MaterialContext& context, glm::vec3 wi, float u_lobe, glm::vec2 u) {
  const one_lane::Material m = lane_of_type<Type>(context);
  return sample_of(one_lane::sample_bsdf(m, lane_of(wi), u_lobe, {u.x, u.y}, kActive));
}

// All but diffuse materials are called: in line, their registers would be saved for all.
template <KbMaterialType Type>
[[gnu::noinline]] BsdfValue call_eval(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo) {
  return eval_type<Type>(context, wi, wo);
}
template <KbMaterialType Type>
[[gnu::noinline]] BsdfSample call_sample(const MaterialContext& context, glm::vec3 wi, float u_lobe,
                                         glm::vec2 u) {
  return sample_type<Type>(context, wi, u_lobe, u);
}

}  // namespace

float lobe_albedo(const MaterialContext& context, glm::vec3 wi) {
  return one_lane::lobe_albedo(lane_of(context), lane_of(wi), kActive).v;
}

BsdfValue eval_bsdf(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo) {
  switch (context.material->type) {
    case KB_MATERIAL_DIFFUSE:
      return eval_type<KB_MATERIAL_DIFFUSE>(context, wi, wo);
    case KB_MATERIAL_ROUGH_CONDUCTOR:
      return call_eval<KB_MATERIAL_ROUGH_CONDUCTOR>(context, wi, wo);
    case KB_MATERIAL_ROUGH_DIELECTRIC:
      check_rough_dielectric(context);
      return call_eval<KB_MATERIAL_ROUGH_DIELECTRIC>(context, wi, wo);
    case KB_MATERIAL_PLASTIC:
      return call_eval<KB_MATERIAL_PLASTIC>(context, wi, wo);
    case KB_MATERIAL_ROUGH_PLASTIC:
      check_rough_plastic(context);
      return call_eval<KB_MATERIAL_ROUGH_PLASTIC>(context, wi, wo);
    case KB_MATERIAL_PRINCIPLED:
      return value_of(
          one_lane::eval_bsdf(PrincipledLane(context).material, lane_of(wi), lane_of(wo), kActive));
    default:
      return {};
  }
}

BsdfSample sample_bsdf(const MaterialContext& context, glm::vec3 wi, float u_lobe, glm::vec2 u) {
  switch (context.material->type) {
    case KB_MATERIAL_DIFFUSE:
      return sample_type<KB_MATERIAL_DIFFUSE>(context, wi, u_lobe, u);
    case KB_MATERIAL_CONDUCTOR:
      return call_sample<KB_MATERIAL_CONDUCTOR>(context, wi, u_lobe, u);
    case KB_MATERIAL_ROUGH_CONDUCTOR:
      return call_sample<KB_MATERIAL_ROUGH_CONDUCTOR>(context, wi, u_lobe, u);
    case KB_MATERIAL_DIELECTRIC:
      return call_sample<KB_MATERIAL_DIELECTRIC>(context, wi, u_lobe, u);
    case KB_MATERIAL_ROUGH_DIELECTRIC:
      check_rough_dielectric(context);
      return call_sample<KB_MATERIAL_ROUGH_DIELECTRIC>(context, wi, u_lobe, u);
    case KB_MATERIAL_PLASTIC:
      return call_sample<KB_MATERIAL_PLASTIC>(context, wi, u_lobe, u);
    case KB_MATERIAL_ROUGH_PLASTIC:
      check_rough_plastic(context);
      return call_sample<KB_MATERIAL_ROUGH_PLASTIC>(context, wi, u_lobe, u);
    case KB_MATERIAL_PRINCIPLED:
      return sample_of(
          one_lane::sample_bsdf(PrincipledLane(context).material, lane_of(wi), u_lobe, {u.x, u.y}, kActive));
    default:
      return {};
  }
}

BsdfSample transmit_dispersive(const KbMaterial& material, glm::vec3 wi, float eta_channel,
                               float probability) {
  return sample_of(one_lane::transmit_dispersive(one_lane::one_material(material), lane_of(wi), eta_channel,
                                                 probability, kActive));
}

BoundaryPair rough_boundary_pair(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo) {
  if (wi.z == 0 || wo.z == 0) return {};
  const one_lane::BoundaryPair pair =
      one_lane::rough_boundary_pair(one_lane::one_material(material), lane_of(wi), lane_of(wo), kActive);
  return {pair.weight.v, pair.cosine.v, pair.transmission.v};
}

bool acts_smooth(const KbMaterial& material, std::span<const float> etas) {
  const one_lane::Facets facets = one_lane::facets_of(one_lane::one_material(material));
  return std::ranges::any_of(etas, [&](float eta) {
    return one_lane::acts_smooth(facets, eta).v || one_lane::acts_smooth(facets, 1 / eta).v;
  });
}

glm::vec3 cosine_direction(glm::vec2 u) {
  const one_lane::V3 w = one_lane::cosine_hemisphere(u.x, u.y);
  return {w.x.v, w.y.v, w.z.v};
}

uint8_t eval_kind(const KbMaterial& material) {
  return static_cast<uint8_t>(one_lane::eval_kind(material.type, material.flags).v);
}

bool has_smooth_lobe(const KbMaterial& material) {
  return one_lane::has_smooth_lobe(material.type).v;
}

}  // namespace kiloband::cpu
