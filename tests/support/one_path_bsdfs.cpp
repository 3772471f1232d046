#include "tests/support/one_path_bsdfs.hpp"

#include <stdexcept>

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/bsdf/bsdf-inl.hpp"

namespace kiloband::test {

using cpu::to_glm;
using cpu::to_lane;
namespace one_lane = cpu::one_lane;

namespace {

using one_lane::F;
using one_lane::M;
using one_lane::U;

constexpr M kActive{true};

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
  return {to_glm(s.wo), s.w0.v,           s.w1.v,
          s.pdf.v,      s.eta.v,          s.bound.v,
          s.delta.v,    s.transmission.v, static_cast<uint8_t>(s.kind.v),
          s.lobe_b.v,   s.needs_channel.v};
}

void check(const MaterialContext& context) {
  const KbMaterial& material = *context.material;
  if (material.type == KB_MATERIAL_ROUGH_PLASTIC && !context.table)
    throw std::logic_error("rough plastic without its transmittance table");
  if (material.type == KB_MATERIAL_ROUGH_DIELECTRIC && (material.flags & KB_MATERIAL_DISPERSIVE) &&
      !(context.dispersion.eta > 0))
    throw std::logic_error("rough dispersive dielectric that is not degraded");
  if (material.type == KB_MATERIAL_PRINCIPLED && !context.table)
    throw std::logic_error("principled material without its numbers");
}

/// A material with all that belongs to it.
struct MaterialLane {
  explicit MaterialLane(const MaterialContext& context) : material(lane_of(context)) {
    check(context);
    if (context.material->type != KB_MATERIAL_PRINCIPLED) return;
    for (uint32_t n = 0; n < KB_PRINCIPLED_NUMBERS; ++n) numbers.number[n] = F(context.table[n]);
    material.principled = &numbers;
    one_lane::set_principled_alpha(material, kActive);
  }
  MaterialLane(const MaterialLane&) = delete;
  MaterialLane& operator=(const MaterialLane&) = delete;

  one_lane::Material material;
  one_lane::Principled numbers;
};

}  // namespace

float lobe_albedo(const MaterialContext& context, glm::vec3 wi) {
  return one_lane::lobe_albedo(lane_of(context), to_lane(wi), kActive).v;
}

BsdfValue eval_bsdf(const MaterialContext& context, glm::vec3 wi, glm::vec3 wo) {
  const one_lane::BsdfValue v =
      one_lane::eval_bsdf(MaterialLane(context).material, to_lane(wi), to_lane(wo), kActive);
  return {v.w0.v, v.w1.v, v.pdf.v, v.lobe_b.v};
}

BsdfSample sample_bsdf(const MaterialContext& context, glm::vec3 wi, float u_lobe, glm::vec2 u) {
  return sample_of(
      one_lane::sample_bsdf(MaterialLane(context).material, to_lane(wi), u_lobe, to_lane(u), kActive));
}

BsdfSample transmit_dispersive(const KbMaterial& material, glm::vec3 wi, float eta_channel,
                               float probability) {
  return sample_of(one_lane::transmit_dispersive(one_lane::one_material(material), to_lane(wi), eta_channel,
                                                 probability, kActive));
}

BoundaryPair rough_boundary_pair(const KbMaterial& material, glm::vec3 wi, glm::vec3 wo) {
  if (wi.z == 0 || wo.z == 0) return {};
  const one_lane::BoundaryPair pair =
      one_lane::rough_boundary_pair(one_lane::one_material(material), to_lane(wi), to_lane(wo), kActive);
  return {pair.weight.v, pair.cosine.v, pair.transmission.v};
}

uint8_t eval_kind(const KbMaterial& material) {
  return static_cast<uint8_t>(one_lane::eval_kind(material.type, material.flags).v);
}

bool has_smooth_lobe(const KbMaterial& material) {
  return one_lane::has_smooth_lobe(material.type).v;
}

}  // namespace kiloband::test
