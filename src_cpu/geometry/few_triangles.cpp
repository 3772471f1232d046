#include "src_cpu/geometry/few_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "scene/compile/record_vectors.hpp"
#include "src_cpu/geometry/boundary.hpp"

namespace kiloband::cpu {
namespace {

/// Index of a place, which is added where it is new.
uint32_t corner_at(std::vector<KbFloat3>& corners, const KbFloat3& place) {
  const auto same = [&](const KbFloat3& c) { return c.x == place.x && c.y == place.y && c.z == place.z; };
  const auto found = std::ranges::find_if(corners, same);
  const auto index = static_cast<uint32_t>(found - corners.begin());
  if (found == corners.end()) corners.push_back(place);
  return index;
}

void add_triangle(FewTriangles& few, const FlatScene& scene, uint32_t shape, uint32_t primitive) {
  const std::size_t first = 3 * (std::size_t{scene.shapes[shape].first_triangle} + primitive);
  FewTriangles::Triangle triangle{.shape = shape, .primitive = primitive};
  glm::dvec3 p[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const KbFloat3& place = scene.positions[scene.triangles[first + i]];
    p[i] = kiloband::to_glm(place);
    triangle.corners[i] = corner_at(few.corners, place);
  }
  const glm::dvec3 product = cross(p[1] - p[0], p[2] - p[0]);
  const double area2 = length(product);
  triangle.inverse_area2 = static_cast<float>(1 / area2);
  if (!std::isfinite(triangle.inverse_area2)) return;
  for (int axis = 0; axis < 3; ++axis) triangle.normal[axis] = static_cast<float>(product[axis] / area2);
  few.triangles.push_back(triangle);
}

}  // namespace

std::optional<FewTriangles> find_few_triangles(const FlatScene& scene, std::size_t most) {
  const SceneFeatures& has = scene.features;
  if (scene.triangles.size() / 3 > std::min(most, kMostFewTriangles) || has.instances ||
      has.analytic_shapes || has_boundaries(scene))
    return {};
  FewTriangles few;
  for (uint32_t shape = 0; shape < scene.shapes.size(); ++shape)
    for (uint32_t i = 0; i < scene.shapes[shape].triangle_count; ++i) add_triangle(few, scene, shape, i);
  if (few.triangles.empty()) return {};
  return few;
}

}  // namespace kiloband::cpu
