#include "path_comparison.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "src_cpu/evaluator.hpp"

namespace kiloband::test {
namespace {

constexpr float kRelative = 1e-4f;  // what the backends owe each other
constexpr float kFloor = 1e-3f;     // of the path's largest weight

bool same_hits(const TracedPath& a, const TracedPath& b) {
  return std::ranges::equal(a.hits, b.hits, [](const TracedHit& x, const TracedHit& y) {
    return x.shape == y.shape && (x.shape == KB_NONE || x.primitive == y.primitive);
  });
}

bool has_two_terms(uint32_t head) {
  const uint32_t kind = head & KB_VERTEX_KIND_MASK;
  return kind == KB_KIND_TWO_TERM || kind == KB_KIND_NONLINEAR;
}

bool has_cosine(uint32_t head) {
  const uint32_t kind = head & KB_VERTEX_KIND_MASK;
  return kind == KB_KIND_CONDUCTOR || kind == KB_KIND_DISPERSIVE;
}

/// Vertices of the same kind that refer to the same spectra; fields that their flags leave out do not count.
bool same_decisions(const KbPathVertex& a, const KbPathVertex& b) {
  if (a.head != b.head) return false;
  const auto read = [&](uint32_t uses, uint32_t textured) { return (a.head & uses) && !(a.head & textured); };
  constexpr uint32_t kReflects = KB_VERTEX_NEE | KB_VERTEX_SCATTER;
  if (read(kReflects, KB_VERTEX_TEX_A) && a.row_a != b.row_a) return false;
  if (has_two_terms(a.head) && read(kReflects, KB_VERTEX_TEX_B) && a.row_b != b.row_b) return false;
  if (read(KB_VERTEX_EMIT, KB_VERTEX_TEX_EMIT) && a.emit_row != b.emit_row) return false;
  if (read(KB_VERTEX_NEE, KB_VERTEX_TEX_NEE) && a.nee_row != b.nee_row) return false;
  return !(a.head & KB_VERTEX_DEGRADE) || kb_as_u32(a.scatter1) == kb_as_u32(b.scatter1);
}

/// A vertex's numbers: weights, and what stands beside them as a cosine.
struct Numbers {
  float weights[5] = {};
  float cosines[2] = {};

  float largest() const { return *std::ranges::max_element(weights); }
};

Numbers numbers_of(const KbPathVertex& v) {
  Numbers n;
  if (v.head & KB_VERTEX_EMIT) n.weights[0] = v.emit_weight;
  if (v.head & KB_VERTEX_NEE) {
    n.weights[1] = v.nee0;
    if (has_two_terms(v.head)) n.weights[2] = v.nee1;
    if (has_cosine(v.head)) n.cosines[0] = v.nee1;
  }
  if (v.head & KB_VERTEX_SCATTER) {
    n.weights[3] = v.scatter0;
    if (has_two_terms(v.head)) n.weights[4] = v.scatter1;
    if (has_cosine(v.head) && !(v.head & KB_VERTEX_DEGRADE)) n.cosines[1] = v.scatter1;
  }
  return n;
}

bool agree(const Numbers& a, const Numbers& b, float path_largest) {
  for (int i = 0; i < 5; ++i) {
    const float x = a.weights[i], y = b.weights[i];
    const float larger = std::max({std::abs(x), std::abs(y), kFloor * path_largest});
    if (!(std::abs(x - y) <= kRelative * larger)) return false;
  }
  for (int i = 0; i < 2; ++i) {
    if (!(std::abs(a.cosines[i] - b.cosines[i]) <= kRelative)) return false;
  }
  return true;
}

/// Texture samples behind a vertex.
std::size_t sample_count(uint32_t head) {
  return static_cast<std::size_t>(std::popcount(head & KB_VERTEX_TEX_MASK));
}

KbTextureSample texture_sample(const TracedPath& path, std::size_t vertex, std::size_t i) {
  KbTextureSample sample;
  const auto* bytes = reinterpret_cast<const char*>(&path.slots[vertex + 1 + i / 2]);
  std::memcpy(&sample, bytes + (i % 2) * sizeof sample, sizeof sample);
  return sample;
}

/// Indices of the vertices among the slots.
std::vector<std::size_t> vertices_of(const TracedPath& path) {
  std::vector<std::size_t> vertices;
  for (std::size_t i = 0; i < path.slots.size(); i += 1 + (sample_count(path.slots[i].head) + 1) / 2)
    vertices.push_back(i);
  return vertices;
}

Parting compare_samples(const TracedPath& a, const TracedPath& b, std::size_t vertex) {
  Parting parting = Parting::kNone;
  for (std::size_t i = 0; i < sample_count(a.slots[vertex].head); ++i) {
    const KbTextureSample s = texture_sample(a, vertex, i), t = texture_sample(b, vertex, i);
    if (s.texture != t.texture || s.xy != t.xy) return Parting::kDecisions;
    if (!(std::abs(s.fx - t.fx) <= kRelative && std::abs(s.fy - t.fy) <= kRelative))
      parting = Parting::kWeights;
  }
  return parting;
}

}  // namespace

Parting compare_paths(const TracedPath& a, const TracedPath& b) {
  if (a.invalid != b.invalid) return Parting::kDecisions;
  if (a.invalid) return Parting::kNone;
  if (!same_hits(a, b)) return Parting::kHits;
  const std::vector<std::size_t> vertices = vertices_of(a);
  if (vertices != vertices_of(b)) return Parting::kDecisions;
  Parting parting = Parting::kNone;
  float largest = 0;
  for (const std::size_t i : vertices) {
    if (!same_decisions(a.slots[i], b.slots[i])) return Parting::kDecisions;
    const Parting samples = compare_samples(a, b, i);
    if (samples == Parting::kDecisions) return samples;
    if (samples == Parting::kWeights) parting = samples;
    largest = std::max({largest, numbers_of(a.slots[i]).largest(), numbers_of(b.slots[i]).largest()});
  }
  for (const std::size_t i : vertices) {
    if (!agree(numbers_of(a.slots[i]), numbers_of(b.slots[i]), largest)) parting = Parting::kWeights;
  }
  return parting;
}

double path_value(const FlatScene& scene, const TracedPath& path, double mu) {
  if (path.invalid || path.slots.empty()) return 0;
  const PathBuffer buffer{path.slots, {{0, static_cast<uint32_t>(path.slots.size()), 0}}};
  const std::vector<double> values = evaluate_path_reference(scene, {}, buffer, 0, mu);
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace kiloband::test
