#include "src_cpu/geometry/surface_hit.hpp"

#include <cmath>

#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"

namespace kiloband::cpu {
namespace {

glm::vec3 to_glm(const KbFloat3& v) {
  return {v.x, v.y, v.z};
}

/// dp/du of a triangle with texture coordinates; zero if they are degenerate.
glm::vec3 triangle_tangent(glm::vec3 e1, glm::vec3 e2, const KbFloat2& uv0, const KbFloat2& uv1,
                           const KbFloat2& uv2) {
  const float du1 = uv1.x - uv0.x;
  const float dv1 = uv1.y - uv0.y;
  const float du2 = uv2.x - uv0.x;
  const float dv2 = uv2.y - uv0.y;
  const float determinant = du1 * dv2 - dv1 * du2;
  if (determinant == 0) return glm::vec3(0);
  return (e1 * dv2 - e2 * dv1) / determinant;
}

void fill_mesh_hit(const FlatScene& scene, const KbShape& shape, uint32_t primitive, float u, float v,
                   SurfaceHit& hit) {
  const uint32_t* index = &scene.triangles[3 * (std::size_t{shape.first_triangle} + primitive)];
  const glm::vec3 p0 = to_glm(scene.positions[index[0]]);
  const glm::vec3 p1 = to_glm(scene.positions[index[1]]);
  const glm::vec3 p2 = to_glm(scene.positions[index[2]]);
  hit.triangle = primitive;
  hit.barycentric = {u, v};
  const float w = 1 - u - v;
  hit.point = w * p0 + u * p1 + v * p2;
  const glm::vec3 e1 = p1 - p0;
  const glm::vec3 e2 = p2 - p0;
  hit.geometric_normal = triangle_normal(shape, e1, e2);
  hit.offset = surface_offset(largest_coordinates(p0, p1, p2), hit.geometric_normal);
  hit.departure = off_the_edges(hit.point, {w, u, v}, {p0, p1, p2}, glm::cross(e1, e2), hit.offset);
  hit.shading_normal = triangle_shading_normal(scene, shape, index, {u, v}, hit.geometric_normal);
  hit.uv = {u, v};
  if (shape.flags & KB_SHAPE_HAS_UVS) {
    const KbFloat2& uv0 = scene.uvs[index[0]];
    const KbFloat2& uv1 = scene.uvs[index[1]];
    const KbFloat2& uv2 = scene.uvs[index[2]];
    hit.uv = {w * uv0.x + u * uv1.x + v * uv2.x, w * uv0.y + u * uv1.y + v * uv2.y};
    hit.tangent = triangle_tangent(e1, e2, uv0, uv1, uv2);
  }
}

}  // namespace

glm::vec3 triangle_normal(const KbShape& shape, glm::vec3 e1, glm::vec3 e2) {
  const float turn = kb_winding_is_turned(shape.flags) ? -1.0f : 1.0f;
  const glm::vec3 cross = glm::cross(e1, e2);
  const float length2 = glm::dot(cross, cross);
  // Tiny triangles: the squared length may underflow where the cross product does not.
  if (length2 > 1e-30f) return cross * (turn / std::sqrt(length2));
  return glm::vec3(glm::normalize(glm::cross(glm::dvec3(e1), glm::dvec3(e2)))) * turn;
}

glm::vec3 triangle_shading_normal(const FlatScene& scene, const KbShape& shape, const uint32_t* index,
                                  glm::vec2 barycentric, glm::vec3 geometric_normal) {
  if (!(shape.flags & KB_SHAPE_HAS_NORMALS)) return geometric_normal;
  const float u = barycentric.x, v = barycentric.y, w = 1 - u - v;
  const glm::vec3 n = w * to_glm(scene.normals[index[0]]) + u * to_glm(scene.normals[index[1]]) +
                      v * to_glm(scene.normals[index[2]]);
  const float n2 = glm::dot(n, n);
  const float turn = shape.flags & KB_SHAPE_FLIP_NORMALS ? -1.0f : 1.0f;
  return n2 > 0 ? n * (turn / std::sqrt(n2)) : geometric_normal;
}

SurfaceHit make_surface_hit(const FlatScene& scene, uint32_t shape_index, uint32_t primitive, float u,
                            float v, glm::vec3 ray_origin, glm::vec3 direction, float t) {
  SurfaceHit hit;
  hit.shape = shape_index;
  const KbShape& shape = scene.shapes[shape_index];
  if (shape.type == KB_SHAPE_MESH) {
    fill_mesh_hit(scene, shape, primitive, u, v, hit);
    return hit;
  }
  const glm::dvec3 point = glm::dvec3(ray_origin) + static_cast<double>(t) * glm::dvec3(direction);
  const SurfacePoint surface = analytic_surface(shape, point);
  hit.point = surface.position;
  hit.geometric_normal = hit.shading_normal = surface.normal;
  hit.offset = surface_offset(largest_coordinates(shape), hit.geometric_normal);
  hit.departure = off_the_rim(shape, surface.position, surface.uv, hit.offset);
  hit.tangent = surface.tangent;
  hit.uv = surface.uv;
  return hit;
}

ShadingFrame::ShadingFrame(glm::vec3 normal, glm::vec3 tangent) : z(normal) {
  const glm::vec3 along = tangent - normal * glm::dot(normal, tangent);
  const float length2 = glm::dot(along, along);
  // Of a tangent along the normal only rounding is left: no direction to go by.
  if (length2 > 1e-6f * glm::dot(tangent, tangent)) {
    x = along / std::sqrt(length2);
    y = glm::cross(z, x);
    return;
  }
  // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
  const float sign = std::copysign(1.0f, z.z);
  const float a = -1.0f / (sign + z.z);
  const float b = z.x * z.y * a;
  x = {1.0f + sign * z.x * z.x * a, sign * b, -sign * z.x};
  y = {b, sign + z.y * z.y * a, -z.y};
}

}  // namespace kiloband::cpu
