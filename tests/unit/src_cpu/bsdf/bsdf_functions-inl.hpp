// The answers of bsdf_functions.hpp for the lanes of the file that includes this one.
#if defined(KILOBAND_BSDF_FUNCTIONS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BSDF_FUNCTIONS_INL
#undef KILOBAND_BSDF_FUNCTIONS_INL
#else
#define KILOBAND_BSDF_FUNCTIONS_INL
#endif

#include "bsdf_functions.hpp"
#include "src_cpu/bsdf/bsdf-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// Appends to its rows one after another.
struct AnswerWriter {
  test::LaneAnswers* rows;
  std::size_t size, first, row;
  KB_INLINE void put_row(F value) {
    if (rows->size() == row) rows->emplace_back(size);
    store(value, (*rows)[row++].data() + first);
  }
  KB_INLINE void put_row(M mask) { put_row(select(mask, F(1), F(0))); }
  KB_INLINE void put_row(const V3& v) {
    put_row(v.x);
    put_row(v.y);
    put_row(v.z);
  }
  KB_INLINE void put_row(const BsdfValue& v) {
    put_row(v.w0);
    put_row(v.w1);
    put_row(v.pdf);
    put_row(v.lobe_b);
  }
  KB_INLINE void put_row(const BsdfSample& s) {
    put_row(s.wo);
    put_row(s.w0);
    put_row(s.w1);
    put_row(s.pdf);
    put_row(s.eta);
    put_row(s.bound);
    put_row(s.delta);
    put_row(s.transmission);
    put_row(s.lobe_b);
    put_row(s.needs_channel);
    put_row(to_floats(s.kind));
  }
};

inline test::LaneAnswers answer_queries(const test::LaneQueries& q) {
  test::LaneAnswers answers;
  const std::size_t size = q.material.size();
  for (std::size_t i = 0; i < size; i += kLanes) {
    const auto vector = [&](const auto& v) KB_LAMBDA {
      return V3{load(&v[0][i]), load(&v[1][i]), load(&v[2][i])};
    };
    Material m = gather_material(q.materials, q.tables, load(&q.material[i]));
    m.channel_eta = load(&q.channel_eta[i]);
    const M principled = is_type(m.type, KB_MATERIAL_PRINCIPLED);
    const Principled numbers = gather_principled(q.tables, select(principled, m.table, U(0u)), principled);
    if (any(principled)) {
      m.principled = &numbers;
      set_principled_alpha(m, principled);
    }
    const V3 wi = vector(q.wi), wo = vector(q.wo);
    const M active = load(&q.active[i]) != U(0u);
    const M compensated = active & (m.compensation != U(KB_NONE));
    AnswerWriter writer{&answers, size, i, 0};
    writer.put_row(eval_bsdf(m, wi, wo, active));
    writer.put_row(sample_bsdf(m, wi, load(&q.u_lobe[i]), V2{load(&q.u[0][i]), load(&q.u[1][i])}, active));
    writer.put_row(transmit_dispersive(m, wi, m.channel_eta, load(&q.probability[i]), active));
    const BoundaryPair pair = rough_boundary_pair(m, wi, wo, active);
    writer.put_row(pair.weight);
    writer.put_row(pair.cosine);
    writer.put_row(pair.transmission);
    F albedo(0);
    if (any(compensated)) albedo = select(compensated, lobe_albedo(m, wi, compensated), F(0));
    writer.put_row(albedo);
  }
  return answers;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
