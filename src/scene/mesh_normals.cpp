#include <algorithm>
#include <cmath>

#include "scene/mesh_finish.hpp"

namespace kiloband {
namespace {

using Vec3d = std::array<double, 3>;

Vec3d subtract(const Vec3f& a, const Vec3f& b) {
  return {double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]};
}
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

Vec3d facet_normal(const Mesh& mesh, const std::array<uint32_t, 3>& triangle) {
  const Vec3f& a = mesh.positions[triangle[0]];
  return unit(cross(subtract(mesh.positions[triangle[1]], a), subtract(mesh.positions[triangle[2]], a)));
}

/// Interior angle at `corner` [rad]. atan2 keeps its accuracy for slivers, where acos would not.
double corner_angle(const Mesh& mesh, const std::array<uint32_t, 3>& triangle, int corner) {
  const Vec3f& a = mesh.positions[triangle[corner]];
  const Vec3d to_next = subtract(mesh.positions[triangle[(corner + 1) % 3]], a);
  const Vec3d to_last = subtract(mesh.positions[triangle[(corner + 2) % 3]], a);
  const Vec3d normal = cross(to_next, to_last);
  return std::atan2(std::sqrt(dot(normal, normal)), dot(to_next, to_last));
}

std::vector<Vec3d> weighted_sums(const Mesh& mesh) {
  std::vector<Vec3d> sums(mesh.positions.size(), Vec3d{});
  for (const auto& triangle : mesh.triangles) {
    const Vec3d normal = facet_normal(mesh, triangle);
    if (dot(normal, normal) == 0) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = corner_angle(mesh, triangle, corner);
      for (int axis = 0; axis < 3; ++axis) sums[triangle[corner]][axis] += angle * normal[axis];
    }
  }
  return sums;
}

std::vector<Vec3f> vertex_normals(const Mesh& mesh) {
  // Below this a sum of unit vectors times angles (order 1) is only the rounding error of what cancelled.
  constexpr double kCancelled = 1e-10;
  std::vector<Vec3d> sums = weighted_sums(mesh);
  std::vector<Vec3d> normals(sums.size(), Vec3d{});
  for (size_t i = 0; i < sums.size(); ++i) {
    if (dot(sums[i], sums[i]) > kCancelled * kCancelled) normals[i] = unit(sums[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t vertex : triangle) {
      if (dot(normals[vertex], normals[vertex]) == 0) normals[vertex] = facet_normal(mesh, triangle);
    }
  }
  std::vector<Vec3f> result(normals.size());
  std::transform(normals.begin(), normals.end(), result.begin(), [](const Vec3d& n) {
    return dot(n, n) == 0 ? Vec3f{0, 0, 1} : narrow(n);
  });
  return result;
}

}  // namespace

void compute_vertex_normals(Mesh& mesh) {
  mesh.normals = vertex_normals(mesh);
}

size_t repair_vertex_normals(Mesh& mesh) {
  size_t zeros = 0;
  for (Vec3f& normal : mesh.normals) {
    normal = narrow(unit({normal[0], normal[1], normal[2]}));
    zeros += normal == Vec3f{};
  }
  if (zeros == 0) return 0;
  const std::vector<Vec3f> computed = vertex_normals(mesh);
  for (size_t i = 0; i < mesh.normals.size(); ++i) {
    if (mesh.normals[i] == Vec3f{}) mesh.normals[i] = computed[i];
  }
  return zeros;
}

}  // namespace kiloband
