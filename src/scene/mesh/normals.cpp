#include <algorithm>
#include <cmath>

#include "scene/mesh/finish.hpp"

namespace kiloband {
namespace {

constexpr LinearMap kIdentity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// A mesh as a linear map places it.
struct PlacedMesh {
  const Mesh& mesh;
  const LinearMap& to_world;

  glm::dvec3 edge(uint32_t from, uint32_t to) const {
    const Vec3f &a = mesh.positions[from], &b = mesh.positions[to];
    glm::dvec3 image(0);
    for (int column = 0; column < 3; ++column) {
      const double along = double(b[column]) - a[column];
      for (int axis = 0; axis < 3; ++axis) image[axis] += along * to_world[column][axis];
    }
    return image;
  }
};

/// v / |v|, or 0 for the zero vector. Floats squared stay far inside the range of double.
glm::dvec3 unit(const glm::dvec3& v) {
  const double length = std::sqrt(dot(v, v));
  return length > 0 ? v / length : glm::dvec3(0);
}

Vec3f narrow(const glm::dvec3& v) {
  return {float(v[0]), float(v[1]), float(v[2])};
}

glm::dvec3 facet_normal(const PlacedMesh& placed, const std::array<uint32_t, 3>& triangle) {
  return unit(cross(placed.edge(triangle[0], triangle[1]), placed.edge(triangle[0], triangle[2])));
}

/// Interior angle at `corner` [rad]. atan2 keeps its accuracy for slivers, where acos would not.
double corner_angle(const PlacedMesh& placed, const std::array<uint32_t, 3>& triangle, int corner) {
  const glm::dvec3 to_next = placed.edge(triangle[corner], triangle[(corner + 1) % 3]);
  const glm::dvec3 to_last = placed.edge(triangle[corner], triangle[(corner + 2) % 3]);
  const glm::dvec3 normal = cross(to_next, to_last);
  return std::atan2(std::sqrt(dot(normal, normal)), dot(to_next, to_last));
}

std::vector<glm::dvec3> weighted_sums(const PlacedMesh& placed) {
  std::vector<glm::dvec3> sums(placed.mesh.positions.size(), glm::dvec3(0));
  for (const auto& triangle : placed.mesh.triangles) {
    const glm::dvec3 normal = facet_normal(placed, triangle);
    if (dot(normal, normal) == 0) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = corner_angle(placed, triangle, corner);
      sums[triangle[corner]] += angle * normal;
    }
  }
  return sums;
}

}  // namespace

std::vector<Vec3f> mapped_vertex_normals(const Mesh& mesh, const LinearMap& to_world) {
  // Below this a sum of unit vectors times angles (order 1) is only the rounding error of what cancelled.
  constexpr double kCancelled = 1e-10;
  const PlacedMesh placed{mesh, to_world};
  std::vector<glm::dvec3> sums = weighted_sums(placed);
  std::vector<glm::dvec3> normals(sums.size(), glm::dvec3(0));
  for (size_t i = 0; i < sums.size(); ++i) {
    if (dot(sums[i], sums[i]) > kCancelled * kCancelled) normals[i] = unit(sums[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t vertex : triangle) {
      if (dot(normals[vertex], normals[vertex]) == 0) normals[vertex] = facet_normal(placed, triangle);
    }
  }
  std::vector<Vec3f> result(normals.size());
  std::transform(normals.begin(), normals.end(), result.begin(), [](const glm::dvec3& n) {
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
    glm::dvec3 sum(0);
    for (const uint32_t vertex : triangle) sum += to_glm(mesh.normals[vertex]);
    return dot(facet_normal({mesh, kIdentity}, triangle), sum) < 0;
  };
  return static_cast<size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), opposed));
}

size_t repair_vertex_normals(Mesh& mesh) {
  size_t zeros = 0;
  for (Vec3f& normal : mesh.normals) {
    normal = narrow(unit(to_glm(normal)));
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
