// Vertices under construction, and how they are saved.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_VERTEX_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_VERTEX_INL
#undef KILOBAND_VERTEX_INL
#else
#define KILOBAND_VERTEX_INL
#endif

#include <algorithm>
#include <cstring>

#include "shared/estimator.h"
#include "src_cpu/geometry/texture/texture-inl.hpp"
#include "src_cpu/path/wave.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// KbPathVertex in lanes, with the lookups that may follow it.
struct Vertex {
  U head;
  F emit_weight, nee0, nee1, scatter0, scatter1;
  F scale;  // largest spectral factor of its weights, where that is not of order 1
  Resolved a, b, emission, light;

  KB_INLINE M has(uint32_t flags) const { return has_bits(head, flags); }
  KB_INLINE void set(M m, uint32_t flags) { head = select(m, head | U(flags), head); }
  KB_INLINE void clear(M m, uint32_t flags) { head = select(m, head & U(~flags), head); }
  KB_INLINE U kind() const { return head & U(KB_VERTEX_KIND_MASK); }
  KB_INLINE void set_kind(M m, U kind) { head = select(m, (head & U(~KB_VERTEX_KIND_MASK)) | kind, head); }
  /// kb_has_two_spectra(), kb_has_two_weights()
  KB_INLINE M has_two_spectra() const {
    return (kind() == U(KB_KIND_TWO_TERM)) | (kind() == U(KB_KIND_NONLINEAR));
  }
  KB_INLINE M has_two_weights() const { return has_two_spectra() | (kind() == U(KB_KIND_TINTED)); }
};

KB_INLINE Vertex empty_vertex() {
  const Resolved none = resolved_row(U(0u));
  return {U(0u), F(0), F(0), F(0), F(0), F(0), F(1), none, none, none, none};
}

/// Multiplies magnitudes by the vertices' scatter weights; false where a contribution could leave the range of
/// floats or is NaN already.
KB_INLINE M stays_finite(const Vertex& v, F& magnitude) {
  const M two = v.has_two_weights();
  const F emitted = select(v.has(KB_VERTEX_EMIT), v.emit_weight, F(0));
  const F lit = select(v.has(KB_VERTEX_NEE), abs(v.nee0) + select(two, abs(v.nee1), F(0)), F(0));
  const M fits = magnitude * (emitted + v.scale * lit) < F(KB_LARGEST_WEIGHT);
  const F scattered = v.scale * (abs(v.scatter0) + select(two, abs(v.scatter1), F(0)));
  magnitude = select(v.has(KB_VERTEX_SCATTER), magnitude * scattered, magnitude);
  return fits & (magnitude < F(KB_LARGEST_WEIGHT));
}

/// Vertices in memory, one after another.
struct VertexArrays {
  WordArray head, rows, sources, emit_weight, nee0, nee1, scatter0, scatter1;

  KB_INLINE explicit VertexArrays(const Vertex& v)
      : head(v.head),
        rows(v.a.row | shift_left<16>(v.b.row)),
        sources(v.emission.row | shift_left<16>(v.light.row)),
        emit_weight(as_words(v.emit_weight)),
        nee0(as_words(v.nee0)),
        nee1(as_words(v.nee1)),
        scatter0(as_words(v.scatter0)),
        scatter1(as_words(v.scatter1)) {}

  KB_INLINE void copy(uint32_t i, KbPathVertex& to) const {
    const uint32_t words[8] = {head[i], rows[i], sources[i],  emit_weight[i],
                               nee0[i], nee1[i], scatter0[i], scatter1[i]};
    std::memcpy(&to, words, sizeof words);
  }
};

/// The lookups of vertices, in memory.
struct LookupArrays {
  WordArray texture, xy;
  FloatArray fx, fy;

  KB_INLINE explicit LookupArrays(const TextureSample& s)
      : texture(s.texture), xy(s.xy), fx(s.fx), fy(s.fy) {}
  KB_INLINE KbTextureSample at(uint32_t i) const { return {texture[i], xy[i], fx[i], fy[i]}; }
};

/// Saves the lookups that vertex `i` has, two to an entry, in the order of path_vertex.h.
inline void append_lookups(Wave& wave, uint32_t head, uint32_t i, const LookupArrays (&lookups)[4]) {
  constexpr uint32_t kFlags[4] = {KB_VERTEX_TEX_A, KB_VERTEX_TEX_B, KB_VERTEX_TEX_EMIT, KB_VERTEX_TEX_NEE};
  KbTextureSample samples[4];
  uint32_t count = 0;
  for (uint32_t k = 0; k < 4; ++k)
    if (head & kFlags[k]) samples[count++] = lookups[k].at(i);
  for (uint32_t k = 0; k < count; k += 2)
    wave.entries.emplace_back(&samples[k], std::min(count - k, 2u) * sizeof(KbTextureSample));
}

/// Saves the vertices of lanes m at the ends of their paths. path: indices in the wave
inline void append(Wave& wave, U path, const Vertex& v, M m) {
  const U safe_path = select(m, path, U(0u));
  F magnitude = KB_GATHER_FLOAT(wave.paths.data(), PathState, magnitude, safe_path);
  const uint32_t fits = bits_of(stays_finite(v, magnitude));
  const FloatArray magnitudes(magnitude);
  const WordArray paths(path);
  const VertexArrays arrays(v);
  const LookupArrays lookups[4] = {LookupArrays(v.a.sample), LookupArrays(v.b.sample),
                                   LookupArrays(v.emission.sample), LookupArrays(v.light.sample)};
  each_lane(m, [&](uint32_t i) KB_LAMBDA {
    PathState& state = wave.paths[paths[i]];
    state.magnitude = magnitudes[i];
    if (!(fits >> i & 1)) state.flags |= kInvalidPath;
    arrays.copy(i, add_entry(wave, state).vertex);
    if (arrays.head[i] & KB_VERTEX_TEX_MASK) append_lookups(wave, arrays.head[i], i, lookups);
  });
  wave.vertices += count(m);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
