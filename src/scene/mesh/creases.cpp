// Vertices split where a surface has creases.
#include "scene/mesh/creases.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_set>

#include "scene/mesh/finish.hpp"

namespace kiloband {
namespace {

uint32_t bits(float x) {
  return std::bit_cast<uint32_t>(x == 0 ? 0.0f : x);  // -0 is 0
}

/// Calls action with the bits of all that a vertex of the mesh has but its normal.
template <class Action>
void for_words(const Mesh& mesh, uint32_t vertex, Action action) {
  for (int axis = 0; axis < 3; ++axis) action(bits(mesh.positions[vertex][axis]));
  if (!mesh.uvs.empty())
    for (int axis = 0; axis < 2; ++axis) action(bits(mesh.uvs[vertex][axis]));
  for (const auto& [name, values] : mesh.vertex_attributes) action(bits(values[vertex]));
}

struct VertexHash {
  const Mesh& mesh;
  size_t operator()(uint32_t vertex) const {
    uint64_t hash = 0xcbf29ce484222325u;
    for_words(mesh, vertex, [&](uint32_t word) { hash = (hash ^ word) * 0x100000001b3u; });
    return hash ^ hash >> 29;
  }
};

struct VertexEqual {
  const Mesh& mesh;
  bool operator()(uint32_t a, uint32_t b) const {
    const auto same = [](float x, float y) { return bits(x) == bits(y); };
    for (int axis = 0; axis < 3; ++axis)
      if (!same(mesh.positions[a][axis], mesh.positions[b][axis])) return false;
    for (int axis = 0; axis < 2 && !mesh.uvs.empty(); ++axis)
      if (!same(mesh.uvs[a][axis], mesh.uvs[b][axis])) return false;
    return std::ranges::all_of(mesh.vertex_attributes, [&](const auto& attribute) {
      return same(attribute.second[a], attribute.second[b]);
    });
  }
};

/// For every vertex the first one at its position with its texture coordinates and attributes.
std::vector<uint32_t> first_equals(const Mesh& mesh) {
  std::vector<uint32_t> first(mesh.positions.size());
  std::unordered_set<uint32_t, VertexHash, VertexEqual> known(first.size(), VertexHash{mesh},
                                                              VertexEqual{mesh});
  for (uint32_t i = 0; i < first.size(); ++i) first[i] = *known.insert(i).first;
  return first;
}

/// Not of unit length; 0 for a triangle without area.
glm::dvec3 facet(const Mesh& mesh, const std::array<uint32_t, 3>& triangle) {
  return double_area_of(mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                        mesh.positions[triangle[2]]);
}

/// The angle between two directions, rad; pi if one is 0.
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  const double lengths = std::sqrt(dot(a, a) * dot(b, b));
  return lengths > 0 ? std::acos(std::clamp(dot(a, b) / lengths, -1.0, 1.0)) : std::acos(-1.0);
}

/// Sets of triangles' corners, number 3 triangle + corner: those that share a vertex.
class CornerSets {
 public:
  explicit CornerSets(size_t corners) : parent_(corners) {
    std::iota(parent_.begin(), parent_.end(), size_t{0});
  }

  size_t find(size_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void join(size_t a, size_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<size_t> parent_;
};

/// An edge of a triangle, between two corners of it.
struct Edge {
  uint32_t low, high;              // vertices
  size_t low_corner, high_corner;  // numbers of CornerSets
};

std::vector<Edge> sorted_edges(const Mesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (size_t c = 0; c < 3; ++c) {
      const size_t d = (c + 1) % 3;
      Edge edge{mesh.triangles[t][c], mesh.triangles[t][d], 3 * t + c, 3 * t + d};
      if (edge.low > edge.high) edge = {edge.high, edge.low, edge.high_corner, edge.low_corner};
      edges.push_back(edge);
    }
  }
  std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.low_corner) < std::tie(b.low, b.high, b.low_corner);
  });
  return edges;
}

/// Joins the corners at both ends of edges whose triangles meet smoothly.
CornerSets smooth_corners(const Mesh& mesh, double most_rad) {
  CornerSets sets(3 * mesh.triangles.size());
  const std::vector<Edge> edges = sorted_edges(mesh);
  for (size_t i = 0; i < edges.size(); ++i) {
    const glm::dvec3 normal = facet(mesh, mesh.triangles[edges[i].low_corner / 3]);
    for (size_t j = i + 1; j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high;
         ++j) {
      if (angle_between(normal, facet(mesh, mesh.triangles[edges[j].low_corner / 3])) > most_rad) continue;
      sets.join(edges[i].low_corner, edges[j].low_corner);
      sets.join(edges[i].high_corner, edges[j].high_corner);
    }
  }
  return sets;
}

}  // namespace

void split_at_creases(Mesh& mesh, double most_rad) {
  const std::vector<uint32_t> first = first_equals(mesh);
  for (auto& triangle : mesh.triangles)
    for (uint32_t& vertex : triangle) vertex = first[vertex];
  CornerSets sets = smooth_corners(mesh, most_rad);
  Mesh split;
  std::vector<uint32_t> vertex_of(3 * mesh.triangles.size(), UINT32_MAX);  // by set
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t from = mesh.triangles[t][c];
      uint32_t& to = vertex_of[sets.find(3 * t + c)];
      if (to == UINT32_MAX) {
        to = static_cast<uint32_t>(split.positions.size());
        split.positions.push_back(mesh.positions[from]);
        if (!mesh.uvs.empty()) split.uvs.push_back(mesh.uvs[from]);
        for (const auto& [name, values] : mesh.vertex_attributes)
          split.vertex_attributes[name].push_back(values[from]);
      }
      mesh.triangles[t][c] = to;
    }
  }
  split.triangles = std::move(mesh.triangles);
  split.face_attributes = std::move(mesh.face_attributes);
  split.byte_attributes = std::move(mesh.byte_attributes);
  mesh = std::move(split);
}

}  // namespace kiloband
