#include "src_cpu/geometry/bump.hpp"

#include <algorithm>
#include <cmath>

#include "shared/estimator.h"
#include "shared/warp.h"
#include "src_cpu/geometry/shape_geometry_affine.hpp"
#include "src_cpu/geometry/texture/texel_corners.hpp"
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/geometry/surface_hit-inl.hpp"

namespace kiloband::cpu {
namespace {

glm::vec3 vector(const KbFloat3& v) {
  return {v.x, v.y, v.z};
}
glm::vec2 vector(const KbFloat2& v) {
  return {v.x, v.y};
}

/// dp/du, dp/dv; where a mesh has no texture coordinates, its barycentric ones take their place.
struct SurfaceTangents {
  glm::vec3 du, dv;
};

SurfaceTangents mesh_tangents(const FlatScene& scene, const KbShape& shape, uint32_t primitive) {
  const uint32_t* index = &scene.triangles[3 * (std::size_t{shape.first_triangle} + primitive)];
  const glm::vec3 p0 = vector(scene.positions[index[0]]);
  glm::vec3 e1 = vector(scene.positions[index[1]]) - p0, e2 = vector(scene.positions[index[2]]) - p0;
  if (shape.flags & KB_SHAPE_INSTANCED) {
    e1 = transform_vector(shape.to_world, e1);
    e2 = transform_vector(shape.to_world, e2);
  }
  if (!(shape.flags & KB_SHAPE_HAS_UVS)) return {e1, e2};
  const glm::vec2 uv0 = vector(scene.uvs[index[0]]);
  const glm::vec2 d1 = vector(scene.uvs[index[1]]) - uv0, d2 = vector(scene.uvs[index[2]]) - uv0;
  const float determinant = d1.x * d2.y - d1.y * d2.x;
  if (determinant == 0) return {glm::vec3(0), glm::vec3(0)};
  return {(e1 * d2.y - e2 * d1.y) / determinant, (e2 * d1.x - e1 * d2.x) / determinant};
}

SurfaceTangents canonical_tangents(uint32_t type, glm::vec2 uv) {
  constexpr float kTurn = 2 * KB_PI;
  const float phi = kTurn * (type == KB_SHAPE_DISK ? uv.y : uv.x);
  const glm::vec3 outwards(std::cos(phi), std::sin(phi), 0), around(-outwards.y, outwards.x, 0);
  if (type == KB_SHAPE_DISK) return {outwards, kTurn * uv.x * around};
  if (type == KB_SHAPE_CYLINDER) return {kTurn * around, {0, 0, 1}};
  const float sine = std::sin(KB_PI * uv.y), cosine = std::cos(KB_PI * uv.y);
  return {kTurn * sine * around, KB_PI * glm::vec3(cosine * outwards.x, cosine * outwards.y, -sine)};
}

/// The derivative of a lookup's place among texels by the coordinate x in texels: texels are stored in ascending order, in mirrored
/// images too.
float axis_slope(double x, uint32_t size, uint32_t wrap) {
  if (wrap == KB_WRAP_REPEAT) return 1;
  if (wrap == KB_WRAP_CLAMP) return x > 0 && x < size - 1.0 ? 1.0f : 0.0f;
  if (!(std::abs(x) < double{KB_LARGEST_COORDINATE})) return 0;
  const double period = 2.0 * size, whole = std::floor(x), i = whole - period * std::floor(whole / period);
  if (i == size - 1.0 || i == period - 1) return 0;
  return i < size - 1.0 ? 1.0f : -1.0f;
}

SurfaceTangents surface_tangents(const FlatScene& scene, uint32_t shape, uint32_t primitive, glm::vec2 uv) {
  const KbShape& record = scene.shapes[shape];
  if (record.type == KB_SHAPE_MESH) return mesh_tangents(scene, record, primitive);
  const SurfaceTangents own = canonical_tangents(record.type, uv);
  return {transform_vector(record.to_world, own.du), transform_vector(record.to_world, own.dv)};
}

/// dh/du, dh/dv of a texture of heights.
glm::vec2 height_gradient(const FlatScene& scene, uint32_t index, glm::vec2 uv) {
  const KbTexture& texture = scene.textures[index];
  if (texture.flags & KB_TEXTURE_NEAREST) return {0, 0};
  const KbTextureSample sample = sample_bitmap(texture, index, uv);
  const TexelCorners corners(texture, sample);
  const auto height = [&](int corner) { return scene.texels[texture.first_texel + corners.texel[corner]].w; };
  const float* m = texture.to_uv;
  const auto coordinate = [&](const float* row, uint32_t size) {
    return (double{row[0]} * double{uv.x} + double{row[1]} * double{uv.y} + double{row[2]}) * size - 0.5;
  };
  const float x = axis_slope(coordinate(m, texture.width), texture.width, texture.wrap) *
                  static_cast<float>(texture.width) *
                  ((1 - sample.fy) * (height(1) - height(0)) + sample.fy * (height(3) - height(2)));
  const float y = axis_slope(coordinate(m + 3, texture.height), texture.height, texture.wrap) *
                  static_cast<float>(texture.height) *
                  ((1 - sample.fx) * (height(2) - height(0)) + sample.fx * (height(3) - height(1)));
  return {x * m[0] + y * m[3], x * m[1] + y * m[4]};
}

/// Of a vector that may be so long or short that its square is not.
glm::vec3 brought_to_one(glm::vec3 v) {
  const glm::vec3 a = glm::abs(v);
  return v / std::max({a.x, a.y, a.z});
}

float share_of_corner(int corner, float fx, float fy) {
  return (corner & 1 ? fx : 1 - fx) * (corner & 2 ? fy : 1 - fy);
}

glm::vec3 height_normal(const FlatScene& scene, const KbBump& bump, const BumpPoint& at) {
  const glm::vec2 slope = height_gradient(scene, bump.texture, at.uv);
  if (slope.x == 0 && slope.y == 0) return at.normal;
  const SurfaceTangents p = surface_tangents(scene, at.shape, at.primitive, at.uv);
  const glm::vec3 n = at.normal;
  const glm::vec3 q = glm::cross(brought_to_one(p.du + n * (slope.x - glm::dot(n, p.du))),
                                 brought_to_one(p.dv + n * (slope.y - glm::dot(n, p.dv))));
  const float length2 = glm::dot(q, q), along = glm::dot(q, n);
  if (!(length2 > 0) || along == 0) return n;  // no tangents, or parallel ones
  return q * ((along < 0 ? -1.0f : 1.0f) / std::sqrt(length2));
}

glm::vec3 mapped_normal(const FlatScene& scene, const KbBump& bump, const BumpPoint& at) {
  const KbTexture& texture = scene.textures[bump.texture];
  const KbTextureSample sample = sample_bitmap(texture, bump.texture, at.uv);
  const TexelCorners corners(texture, sample);
  glm::vec3 local(0);
  for (int corner = 0; corner < 4; ++corner) {
    const KbFloat4& texel = scene.texels[texture.first_texel + corners.texel[corner]];
    local += share_of_corner(corner, sample.fx, sample.fy) * glm::vec3(texel.x, texel.y, texel.z);
  }
  const float length2 = glm::dot(local, local);
  if (!(length2 > 0) || (local.x == 0 && local.y == 0 && local.z > 0)) return at.normal;
  const glm::vec3 du = surface_tangents(scene, at.shape, at.primitive, at.uv).du;
  const one_lane::Frame frame = one_lane::make_frame(to_lane(at.normal), to_lane(du));
  return to_glm(frame.to_world(to_lane(local / std::sqrt(length2))));
}

/// n' turned half around n.
glm::vec3 half_turned(glm::vec3 n, glm::vec3 bumped) {
  return 2 * glm::dot(n, bumped) * n - bumped;
}

}  // namespace

BumpedNormal bumped_normal(const FlatScene& scene, const KbBump& bump, const BumpPoint& at) {
  const bool mapped = scene.textures[bump.texture].flags & KB_TEXTURE_NORMALS;
  glm::vec3 normal = mapped ? mapped_normal(scene, bump, at) : height_normal(scene, bump, at);
  if (normal == at.normal) return {normal, kNotBumped};
  const glm::vec3 n = at.normal;
  if (at.turned && !(bump.flags & KB_BUMP_OUTSIDE)) normal = half_turned(n, normal);
  if ((bump.flags & KB_BUMP_FLIP) && glm::dot(at.away, n) * glm::dot(at.away, normal) <= 0)
    normal = half_turned(n, normal);
  if (!(bump.flags & KB_BUMP_SHADOW)) return {normal, 0, mapped};
  const float cos2 = std::min(glm::dot(n, normal) * glm::dot(n, normal), 1.0f);
  return {normal, std::min(0.125f * (1 - cos2) / std::max(cos2, 1e-6f), 1.0f), mapped};
}

}  // namespace kiloband::cpu
