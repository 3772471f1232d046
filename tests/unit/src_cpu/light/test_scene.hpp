// Small flattened scenes: one light each.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "scene/compile/light/envmap_sampling.hpp"
#include "scene/compile/shape_bounds.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"
#include "src_cpu/geometry/surface_hit.hpp"
#include "tests/support/chi_square.hpp"

namespace kiloband::test {

/// A uniformly distributed unit vector, by rejection.
inline glm::dvec3 random_direction(Uniform& uniform) {
  for (;;) {
    const glm::dvec3 v(2.0 * uniform() - 1, 2.0 * uniform() - 1, 2.0 * uniform() - 1);
    const double length = glm::length(v);
    if (length > 0.01 && length < 1) return v / length;
  }
}

using namespace cpu;

inline void set_matrix(float (&out)[12], const glm::dmat4& m) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out[4 * row + column] = static_cast<float>(m[column][row]);
  }
}

inline glm::dmat4 identity() {
  return glm::dmat4(1.0);
}

/// translate * rotate * scale, with a rotation about a skew axis (radians).
inline glm::dmat4 placed(glm::dvec3 position, double angle, glm::dvec3 scale) {
  const glm::dmat4 moved = glm::translate(identity(), position);
  return glm::scale(glm::rotate(moved, angle, glm::normalize(glm::dvec3(1, 2, -1))), scale);
}

inline KbShape make_shape(uint32_t type, const glm::dmat4& to_world, uint32_t flags = 0) {
  KbShape shape{};
  shape.type = type;
  shape.flags = flags;
  shape.first_cdf = KB_NONE;
  set_matrix(shape.to_world, to_world);
  set_matrix(shape.to_object, glm::inverse(to_world));
  shape.area = static_cast<float>(analytic_area(type, to_world));
  return shape;
}

inline KbEmitter make_emitter(uint32_t type, const glm::dmat4& to_world = identity()) {
  KbEmitter emitter{};
  emitter.type = type;
  emitter.select_pdf = 1;
  set_matrix(emitter.to_world, to_world);
  set_matrix(emitter.to_object, glm::inverse(to_world));
  return emitter;
}

inline FlatScene scene_with(const KbEmitter& emitter) {
  FlatScene scene;
  scene.emitters = {emitter};
  scene.emitter_cdf = {0, 1};
  if (emitter.type == KB_EMITTER_CONSTANT || emitter.type == KB_EMITTER_ENVMAP) scene.environment = 0;
  if (emitter.type == KB_EMITTER_SUN) scene.first_sun = 0;
  return scene;
}

/// A sun towards -Z of to_world, of angular radius in rad.
inline KbEmitter make_sun(double radius, const glm::dmat4& to_world) {
  KbEmitter sun = make_emitter(KB_EMITTER_SUN, to_world);
  sun.one_minus_cos = static_cast<float>(2 * std::pow(std::sin(radius / 2), 2.0));
  sun.scale = static_cast<float>(1 / (3.141592653589793238463 * std::pow(std::sin(radius), 2.0)));
  return sun;
}

/// Shape 0 is an area light of spectrum row 3.
inline FlatScene scene_with_light(const KbShape& shape) {
  KbEmitter emitter = make_emitter(KB_EMITTER_AREA);
  emitter.ref = KB_REF_SPECTRUM | 3u;
  FlatScene scene = scene_with(emitter);
  scene.shapes = {shape};
  scene.shapes[0].emitter = 0;
  return scene;
}

inline glm::dvec3 position_of(const FlatScene& scene, uint32_t index) {
  const KbFloat3& p = scene.positions[index];
  return {p.x, p.y, p.z};
}

/// A mesh light with its table of areas.
inline FlatScene scene_with_mesh(const std::vector<KbFloat3>& positions,
                                 const std::vector<uint32_t>& triangles, uint32_t flags = 0) {
  FlatScene scene = scene_with_light(make_shape(KB_SHAPE_SPHERE, identity(), flags));
  scene.positions = positions;
  scene.triangles = triangles;
  std::vector<double> sums{0};
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const glm::dvec3 p0 = position_of(scene, triangles[i]);
    const glm::dvec3 e1 = position_of(scene, triangles[i + 1]) - p0,
                     e2 = position_of(scene, triangles[i + 2]) - p0;
    sums.push_back(sums.back() + 0.5 * glm::length(glm::cross(e1, e2)));
  }
  KbShape& shape = scene.shapes[0];
  shape.type = KB_SHAPE_MESH;
  shape.triangle_count = static_cast<uint32_t>(triangles.size() / 3);
  shape.first_cdf = 0;
  shape.area = static_cast<float>(sums.back());
  for (const double sum : sums) scene.area_cdf.push_back(static_cast<float>(sum / sums.back()));
  return scene;
}

/// The normals of a mesh light's vertices.
inline void set_normals(FlatScene& scene, const std::vector<KbFloat3>& normals) {
  scene.normals = normals;
  scene.shapes[0].flags |= KB_SHAPE_HAS_NORMALS;
}

/// A quad of the given winding and vertex normals (x, 0, z) and (-x, 0, z), as seen from (0, 0, 0).
inline FlatScene quad_with_normals(bool winding_faces_point, float x, float z, uint32_t flags = 0) {
  const std::vector<uint32_t> triangles =
      winding_faces_point ? std::vector<uint32_t>{0, 2, 1, 0, 3, 2} : std::vector<uint32_t>{0, 1, 2, 0, 2, 3};
  FlatScene scene = scene_with_mesh({{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}}, triangles, flags);
  set_normals(scene, {{x, 0, z}, {-x, 0, z}, {-x, 0, z}, {x, 0, z}});
  return scene;
}

/// What a ray finds of shape 0: the nearest hit; meshes: of which triangle and where in it.
struct Hit {
  bool found = false;
  double t = 1e30;
  uint32_t triangle = 0;
  glm::dvec2 barycentric{0};
};

inline void intersect_triangle(const glm::dvec3 (&p)[3], uint32_t triangle, glm::dvec3 origin,
                               glm::dvec3 direction, Hit& hit) {
  const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double t = glm::dot(n, p[0] - origin) / glm::dot(n, direction);
  if (!(t > 0 && t < hit.t)) return;
  const glm::dvec3 q = origin + t * direction;
  double opposite[3];  // the part of the area that is opposite to a corner
  for (int i = 0; i < 3; ++i) {
    opposite[(i + 2) % 3] = glm::dot(glm::cross(p[(i + 1) % 3] - p[i], q - p[i]), n) / glm::dot(n, n);
    if (opposite[(i + 2) % 3] < 0) return;
  }
  hit = {true, t, triangle, {opposite[1], opposite[2]}};
}

inline Hit trace(const FlatScene& scene, glm::dvec3 origin, glm::dvec3 direction) {
  const KbShape& shape = scene.shapes[0];
  Hit hit;
  if (shape.type != KB_SHAPE_MESH) {
    hit.found = intersect_analytic(shape, origin, direction, 0, 1e30, hit.t);
    return hit;
  }
  for (std::size_t i = 0; i < scene.triangles.size(); i += 3) {
    const uint32_t* v = &scene.triangles[i];
    const glm::dvec3 p[3] = {position_of(scene, v[0]), position_of(scene, v[1]), position_of(scene, v[2])};
    intersect_triangle(p, static_cast<uint32_t>(i / 3), origin, direction, hit);
  }
  return hit;
}

/// The surface that a ray finds.
inline SurfaceHit surface_at(const FlatScene& scene, const Hit& hit, glm::dvec3 origin,
                             glm::dvec3 direction) {
  return make_surface_hit(scene, 0, hit.triangle, static_cast<float>(hit.barycentric.x),
                          static_cast<float>(hit.barycentric.y), glm::vec3(origin), glm::vec3(direction),
                          static_cast<float>(hit.t));
}

/// A point of shape 0 that faces along `normal`.
inline SurfaceHit facing_hit(glm::vec3 point, glm::vec3 normal) {
  SurfaceHit hit;
  hit.shape = 0;
  hit.point = point;
  hit.geometric_normal = hit.shading_normal = normal;
  return hit;
}

/// An environment map of grey texels.
inline FlatScene envmap_scene(uint32_t width, uint32_t height, const std::vector<float>& texels,
                              const glm::dmat4& to_world) {
  KbEmitter emitter = make_emitter(KB_EMITTER_ENVMAP, to_world);
  emitter.ref = KB_REF_BITMAP | 0u;
  FlatScene scene = scene_with(emitter);
  KbTexture texture{};
  texture.width = width;
  texture.height = height;
  texture.flags = KB_TEXTURE_ENVMAP;
  scene.textures = {texture};
  for (const float t : texels) scene.texels.push_back({0, 0, 1e10f, t});
  scene.texel_bounds = texels;
  scene.envmap = build_envmap_sampling(width, height, texels);
  return scene;
}

}  // namespace kiloband::test
