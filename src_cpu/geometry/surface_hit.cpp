#include "src_cpu/geometry/surface_hit.hpp"

#include <cmath>

#include "src_cpu/geometry/analytic_hit.hpp"
#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/geometry/surface_hit-inl.hpp"

namespace kiloband::cpu {

AnalyticHit analytic_hit(const KbShape& shape, glm::vec3 origin, glm::vec3 direction, float distance) {
  const glm::dvec3 point = glm::dvec3(origin) + static_cast<double>(distance) * glm::dvec3(direction);
  AnalyticHit hit{analytic_surface(shape, point), 0, {}};
  hit.offset = surface_offset(largest_coordinates(shape), hit.surface.normal);
  hit.departure = off_the_rim(shape, hit.surface.position, hit.surface.uv, hit.offset);
  return hit;
}

glm::vec3 tiny_normal(glm::vec3 e1, glm::vec3 e2) {
  return glm::vec3(glm::normalize(glm::cross(glm::dvec3(e1), glm::dvec3(e2))));
}

SurfaceHit make_surface_hit(const FlatScene& scene, uint32_t shape, uint32_t primitive, float u, float v,
                            glm::vec3 ray_origin, glm::vec3 direction, float t) {
  one_lane::Hit hit;
  one_lane::make_hit({scene, nullptr}, shape, primitive, u, v, to_lane(ray_origin), to_lane(direction), t,
                     {true}, hit);
  SurfaceHit result;
  result.shape = shape;
  result.point = to_glm(hit.point);
  result.geometric_normal = to_glm(hit.geometric_normal);
  result.shading_normal = to_glm(hit.shading_normal);
  result.tangent = to_glm(hit.tangent);
  result.offset = hit.offset.v;
  result.departure = to_glm(hit.departure);
  result.uv = to_glm(hit.uv);
  if (scene.shapes[shape].type != KB_SHAPE_MESH) return result;
  result.triangle = primitive;
  result.barycentric = {u, v};
  return result;
}

}  // namespace kiloband::cpu
