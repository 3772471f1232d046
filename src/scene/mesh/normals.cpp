#include <algorithm>
#include <cmath>

#include "scene/mesh/finish.hpp"

namespace kiloband {
namespace {

using Vec3d = std::array<double, 3>;

constexpr LinearMap kIdentity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// A mesh as a linear map places it.
struct PlacedMesh {
  const Mesh& mesh;
  const LinearMap& to_world;

  Vec3d edge(uint32_t from, uint32_t to) const {
    const Vec3f &a = mesh.positions[from], &b = mesh.positions[to];
    Vec3d image{};
    for (int column = 0; column < 3; ++column) {
      const double along = double(b[column]) - a[column];
      for (int axis = 0; axis < 3; ++axis) image[axis] += along * to_world[column][axis];
    }
    return image;
  }
};

double dot(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// v / |v|, or 0 for the zero vector. Floats squared stay far inside the range of double.
Vec3d unit(const Vec3d& v) {
  const double length = std::sqrt(dot(v, v));
  return length > 0 ? Vec3d{v[0] / length, v[1] / length, v[2] / length} : Vec3d{};
}

Vec3f narrow(const Vec3d& v) {
  return {float(v[0]), float(v[1]), float(v[2])};
}

Vec3d facet_normal(const PlacedMesh& placed, const std::array<uint32_t, 3>& triangle) {
  return unit(cross(placed.edge(triangle[0], triangle[1]), placed.edge(triangle[0], triangle[2])));
}

/// Interior angle at `corner` [rad]. atan2 keeps its accuracy for slivers, where acos would not.
double corner_angle(const PlacedMesh& placed, const std::array<uint32_t, 3>& triangle, int corner) {
  const Vec3d to_next = placed.edge(triangle[corner], triangle[(corner + 1) % 3]);
  const Vec3d to_last = placed.edge(triangle[corner], triangle[(corner + 2) % 3]);
  const Vec3d normal = cross(to_next, to_last);
  return std::atan2(std::sqrt(dot(normal, normal)), dot(to_next, to_last));
}

std::vector<Vec3d> weighted_sums(const PlacedMesh& placed) {
  std::vector<Vec3d> sums(placed.mesh.positions.size(), Vec3d{});
  for (const auto& triangle : placed.mesh.triangles) {
    const Vec3d normal = facet_normal(placed, triangle);
    if (dot(normal, normal) == 0) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = corner_angle(placed, triangle, corner);
      for (int axis = 0; axis < 3; ++axis) sums[triangle[corner]][axis] += angle * normal[axis];
    }
  }
  return sums;
}

}  // namespace

std::vector<Vec3f> mapped_vertex_normals(const Mesh& mesh, const LinearMap& to_world) {
  // Below this a sum of unit vectors times angles (order 1) is only the rounding error of what cancelled.
  constexpr double kCancelled = 1e-10;
  const PlacedMesh placed{mesh, to_world};
  std::vector<Vec3d> sums = weighted_sums(placed);
  std::vector<Vec3d> normals(sums.size(), Vec3d{});
  for (size_t i = 0; i < sums.size(); ++i) {
    if (dot(sums[i], sums[i]) > kCancelled * kCancelled) normals[i] = unit(sums[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t vertex : triangle) {
      if (dot(normals[vertex], normals[vertex]) == 0) normals[vertex] = facet_normal(placed, triangle);
    }
  }
  std::vector<Vec3f> result(normals.size());
  std::transform(normals.begin(), normals.end(), result.begin(), [](const Vec3d& n) {
    return dot(n, n) == 0 ? Vec3f{0, 0, 1} : narrow(n);
  });
  return result;
}

void compute_vertex_normals(Mesh& mesh) {
  mesh.normals = mapped_vertex_normals(mesh, kIdentity);
}

size_t count_opposed_triangles(const Mesh& mesh) {
  if (mesh.normals.empty()) return 0;
  const auto opposed = [&](const std::array<uint32_t, 3>& triangle) {
    Vec3d sum{};
    for (const uint32_t vertex : triangle)
      for (int axis = 0; axis < 3; ++axis) sum[axis] += mesh.normals[vertex][axis];
    return dot(facet_normal({mesh, kIdentity}, triangle), sum) < 0;
  };
  return static_cast<size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), opposed));
}

size_t repair_vertex_normals(Mesh& mesh) {
  size_t zeros = 0;
  for (Vec3f& normal : mesh.normals) {
    normal = narrow(unit({normal[0], normal[1], normal[2]}));
    zeros += normal == Vec3f{};
  }
  if (zeros == 0) return 0;
  const std::vector<Vec3f> computed = mapped_vertex_normals(mesh, kIdentity);
  for (size_t i = 0; i < mesh.normals.size(); ++i) {
    if (mesh.normals[i] == Vec3f{}) mesh.normals[i] = computed[i];
  }
  return zeros;
}

}  // namespace kiloband
