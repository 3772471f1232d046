#include "path_comparison.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "validation/oracle/evaluate_reference.hpp"

namespace kiloband::test {

using namespace cpu;
namespace {

constexpr double kRelative = 1e-4;  // what the backends owe each other

bool same_hits(const TracedPath& a, const TracedPath& b) {
  return std::ranges::equal(a.hits, b.hits, [](const TracedHit& x, const TracedHit& y) {
    return x.shape == y.shape && (x.shape == KB_NONE || x.primitive == y.primitive);
  });
}

bool has_two_terms(uint32_t head) {
  const uint32_t kind = head & KB_VERTEX_KIND_MASK;
  return kind == KB_KIND_TWO_TERM || kind == KB_KIND_NONLINEAR;
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
  return !(a.head & KB_VERTEX_DEGRADE) || a.scatter1 == b.scatter1;
}

/// Texture samples behind a vertex.
std::size_t sample_count(uint32_t head) {
  return static_cast<std::size_t>(std::popcount(head & KB_VERTEX_TEX_MASK));
}

KbTextureSample texture_sample(const TracedPath& path, std::size_t vertex, std::size_t i) {
  KbTextureSample sample;
  const auto* bytes = reinterpret_cast<const char*>(&path.entries[vertex + 1 + i / 2]);
  std::memcpy(&sample, bytes + (i % 2) * sizeof sample, sizeof sample);
  return sample;
}

/// Indices of the vertices among the slots.
std::vector<std::size_t> vertices_of(const TracedPath& path) {
  std::vector<std::size_t> vertices;
  for (std::size_t i = 0; i < path.entries.size(); i += 1 + kb_vertex_extensions(path.entries[i].head))
    vertices.push_back(i);
  return vertices;
}

bool same_texels(const TracedPath& a, const TracedPath& b, std::size_t vertex) {
  for (std::size_t i = 0; i < sample_count(a.entries[vertex].head); ++i) {
    const KbTextureSample s = texture_sample(a, vertex, i), t = texture_sample(b, vertex, i);
    if (s.texture != t.texture || s.xy != t.xy) return false;
  }
  return true;
}

}  // namespace

Parting compare_decisions(const TracedPath& a, const TracedPath& b) {
  if (a.invalid != b.invalid) return Parting::kDecisions;
  if (a.invalid) return Parting::kNone;
  if (!same_hits(a, b)) return Parting::kHits;
  const std::vector<std::size_t> vertices = vertices_of(a);
  if (vertices != vertices_of(b)) return Parting::kDecisions;
  const bool same = std::ranges::all_of(vertices, [&](std::size_t i) {
    return same_decisions(a.entries[i], b.entries[i]) && same_texels(a, b, i);
  });
  return same ? Parting::kNone : Parting::kDecisions;
}

std::vector<double> path_values(const FlatScene& scene, const TracedPath& path, double mu) {
  if (path.invalid || path.entries.empty()) return std::vector<double>(scene.channels.size(), 0.0);
  const PathBuffer buffer{path.entries, {{0, static_cast<uint32_t>(path.entries.size()), 0}}};
  return evaluate_path_reference(scene, {}, buffer, 0, mu);
}

bool values_agree(const std::vector<double>& a, const std::vector<double>& b, double least) {
  double largest = least;
  for (const std::vector<double>* values : {&a, &b})
    for (const double v : *values) largest = std::max(largest, std::abs(v));
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!(std::abs(a[k] - b[k]) <= kRelative * largest)) return false;
  }
  return true;
}

}  // namespace kiloband::test
