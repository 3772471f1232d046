// Energy compensation of rough materials that emit thermally. Source and table: shared/thermal.h.
//
// For one lane or a vector of them: see lanes/one_lane.hpp and lanes/highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BSDF_COMPENSATION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_COMPENSATION_INL
#undef KILOBAND_BSDF_COMPENSATION_INL
#else
#define KILOBAND_BSDF_COMPENSATION_INL
#endif

#include "shared/thermal.h"
#include "src_cpu/bsdf/microfacet-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// A place between the nodes of a table.
struct TablePlace {
  U node;
  F t;
  U step;  // to the node behind; 0 where t is 0, so that none need be there
};
KB_INLINE TablePlace table_place(F position, F nodes) {
  const F x = min(max(position, F(0)), nodes - F(1));
  const F node = max(min(floor(x), nodes - F(2)), F(0));
  const F t = x - node;
  return {to_words(node), t, select(t > F(0), U(1u), U(0u))};
}

/// s of a direction, in [0, 1].
KB_INLINE F azimuth_position(const Facets& facets, V3 wi, M glass) {
  const F o = select(glass, sqrt(sqrt(facets.alpha_u)), facets.alpha_u);
  const F p = select(glass, sqrt(sqrt(facets.alpha_v)), facets.alpha_v);
  const F px = o * wi.x, py = p * wi.y;
  const F sum = px * px + py * py;
  return select(sum > F(0), py * py / sum, F(0));
}

/// E(wi) of the lanes of `active`, which are compensated.
KB_INLINE F lobe_albedo(const Material& m, V3 wi, M active) {
  const Facets facets = facets_of(m);
  const M glass = is_type(m.type, KB_MATERIAL_ROUGH_DIELECTRIC);
  const U header = select(active, m.compensation, U(0u));
  const auto head = [&](uint32_t i) KB_LAMBDA { return gather(m.tables, header + U(i)); };
  // Other lanes read some table as if it had one node of everything.
  const F nodes_s = select(active, head(0), F(1)), nodes_eta = select(active, head(1), F(1));
  const F root =
      sqrt(facets.alpha_u * facets.alpha_u * wi.x * wi.x + facets.alpha_v * facets.alpha_v * wi.y * wi.y);
  const F cosine = abs(wi.z);
  const TablePlace x =
      table_place(cosine / (cosine + root) * F(KB_COMPENSATION_NODES - 1), F(KB_COMPENSATION_NODES));
  const TablePlace s = table_place(azimuth_position(facets, wi, glass) * (nodes_s - F(1)), nodes_s);
  const TablePlace eta = table_place((index_ratio(m) - head(2)) * head(3), nodes_eta);
  const U width = to_words(nodes_s);
  const U inside = select(active & glass & (wi.z < F(0)), to_words(nodes_eta) * width, U(0u));
  const auto row = [&](U j, U i) KB_LAMBDA {
    const U line = inside + (eta.node + i) * width + s.node + j;
    const U node = header + U(KB_COMPENSATION_HEADER) + line * U(KB_COMPENSATION_NODES) + x.node;
    const F low = gather(m.tables, node);
    return low + x.t * (gather(m.tables, node + x.step) - low);
  };
  const auto plane = [&](U i) KB_LAMBDA {
    const F low = row(U(0u), i);
    return low + s.t * (row(s.step, i) - low);
  };
  const F low = plane(U(0u));
  return low + eta.t * (plane(eta.step) - low);
}

/// Rough materials alone can be.
KB_INLINE M is_compensated(const Material& m) {
  const M rough = is_type(m.type, KB_MATERIAL_ROUGH_CONDUCTOR) |
                  is_type(m.type, KB_MATERIAL_ROUGH_DIELECTRIC) | is_type(m.type, KB_MATERIAL_ROUGH_PLASTIC);
  return rough & (m.compensation != U(KB_NONE));
}

/// Of conductors w0, of the specular lobe of plastics w0, of either lobe of dielectrics.
KB_INLINE void compensate(const Material& m, V3 wi, M active, BsdfValue& value) {
  active = active & is_compensated(m) & (value.w0 > F(0));
  if (any(active)) value.w0 = select(active, value.w0 / lobe_albedo(m, wi, active), value.w0);
}

KB_INLINE void compensate(const Material& m, V3 wi, M active, BsdfSample& sample) {
  active = active & is_compensated(m) & !sample.delta & (sample.pdf > F(0));
  if (!any(active)) return;
  const F gain = F(1) / lobe_albedo(m, wi, active);
  // Of plastic the specular lobe alone.
  const F bound = select(is_type(m.type, KB_MATERIAL_ROUGH_PLASTIC),
                         sample.bound + sample.w0 * (gain - F(1)) * m.bound_a, sample.bound * gain);
  sample.bound = select(active, bound, sample.bound);
  sample.w0 = select(active, sample.w0 * gain, sample.w0);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
