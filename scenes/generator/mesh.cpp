#include "scenes/generator/mesh.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace kiloband::generator {
namespace {

bool less(const Vec3& a, const Vec3& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

/// For each vertex the number of its position among the distinct ones; also that count.
std::pair<std::vector<uint32_t>, uint32_t> distinct_positions(const Mesh& mesh) {
  std::vector<uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    if (mesh.positions[a] == mesh.positions[b]) return a < b;
    return less(mesh.positions[a], mesh.positions[b]);
  });
  std::vector<uint32_t> ids(order.size());
  uint32_t count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && !(mesh.positions[order[i]] == mesh.positions[order[i - 1]])) ++count;
    ids[order[i]] = count;
  }
  return {ids, order.empty() ? 0 : count + 1};
}

/// Twice the area times the normal.
Vec3 area_normal(const Mesh& mesh, const std::array<uint32_t, 3>& t) {
  const Vec3 p = mesh.positions[t[0]];
  return cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p);
}

/// The triangles at each distinct position, one list after the other.
struct Neighbours {
  std::vector<uint32_t> begin, triangles;
};

Neighbours neighbours(const Mesh& mesh, const std::vector<uint32_t>& ids, uint32_t count) {
  Neighbours result;
  result.begin.assign(count + 1, 0);
  for (const auto& t : mesh.triangles) {
    for (const uint32_t v : t) ++result.begin[ids[v] + 1];
  }
  std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
  result.triangles.resize(result.begin.back());
  std::vector<uint32_t> next(result.begin.begin(), result.begin.end() - 1);
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const uint32_t v : mesh.triangles[i]) result.triangles[next[ids[v]]++] = i;
  }
  return result;
}

float rounded(double x) {
  const float f = static_cast<float>(x);
  return f == 0 ? 0.0f : f;  // no negative zero: equal positions have equal bits
}

Vec3 rounded(Vec3 v) {
  return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

}  // namespace

void append(Mesh& a, const Mesh& b) {
  if (!a.positions.empty() && a.normals.empty() != b.normals.empty()) {
    throw std::logic_error("append: one mesh has normals and the other has none");
  }
  if (!a.uvs.empty() || !b.uvs.empty()) a.uvs.resize(a.positions.size());
  const auto first = static_cast<uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  a.uvs.insert(a.uvs.end(), b.uvs.begin(), b.uvs.end());
  if (!a.uvs.empty()) a.uvs.resize(a.positions.size());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Mesh transformed(const Mesh& mesh, const Frame& frame) {
  Mesh result = mesh;
  for (Vec3& p : result.positions) p = frame.point(p);
  // Normals go with the cofactors, which mirroring turns round as well.
  const Frame cofactors{cross(frame.y, frame.z), cross(frame.z, frame.x), cross(frame.x, frame.y), {}};
  const double sign = dot(frame.x, cofactors.x) < 0 ? -1 : 1;
  for (Vec3& n : result.normals) n = normalize(cofactors.direction(n)) * sign;
  if (sign < 0) {
    for (auto& t : result.triangles) std::swap(t[1], t[2]);
  }
  return result;
}

void deform(Mesh& mesh, const std::function<Vec3(Vec3)>& map) {
  for (Vec3& p : mesh.positions) p = map(p);
}

void flip(Mesh& mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  for (Vec3& n : mesh.normals) n = n * -1;
}

double signed_volume6(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    sum += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  return sum;
}

Mesh with_smooth_normals(const Mesh& mesh, double crease_degrees) {
  const auto [ids, count] = distinct_positions(mesh);
  const Neighbours near = neighbours(mesh, ids, count);
  std::vector<Vec3> areas;
  for (const auto& t : mesh.triangles) areas.push_back(area_normal(mesh, t));
  const double limit = cosine(crease_degrees * kPi / 180);

  Mesh result;
  result.triangles = mesh.triangles;
  std::map<std::array<double, 4>, uint32_t> known;  // old vertex and normal -> new vertex
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vec3 own = normalize(areas[i]);
    for (int c = 0; c < 3; ++c) {
      const uint32_t v = mesh.triangles[i][c];
      Vec3 sum;
      for (uint32_t k = near.begin[ids[v]]; k < near.begin[ids[v] + 1]; ++k) {
        const Vec3 other = areas[near.triangles[k]];
        if (dot(normalize(other), own) >= limit) sum = sum + other;
      }
      const Vec3 n = length(sum) > 0 ? normalize(sum) : own;
      const auto [slot, fresh] = known.try_emplace({static_cast<double>(v), n.x, n.y, n.z},
                                                   static_cast<uint32_t>(result.positions.size()));
      if (fresh) {
        result.positions.push_back(mesh.positions[v]);
        result.normals.push_back(n);
        if (!mesh.uvs.empty()) result.uvs.push_back(mesh.uvs[v]);
      }
      result.triangles[i][c] = slot->second;
    }
  }
  return result;
}

void project_uvs(Mesh& mesh, Vec3 u, Vec3 v) {
  mesh.uvs.clear();
  for (const Vec3& p : mesh.positions) mesh.uvs.push_back({dot(p, u), dot(p, v)});
}

Mesh in_single_precision(const Mesh& mesh) {
  if (mesh.normals.size() != mesh.positions.size()) throw std::logic_error("in_single_precision: no normals");
  Mesh result = mesh;
  for (Vec3& p : result.positions) p = rounded(p);
  for (Vec3& n : result.normals) n = rounded(n);
  for (Vec2& t : result.uvs) t = {rounded(t.x), rounded(t.y)};
  std::erase_if(result.triangles,
                [&](const std::array<uint32_t, 3>& t) { return length(area_normal(result, t)) == 0; });
  return result;
}

}  // namespace kiloband::generator
