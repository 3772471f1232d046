// Area lights on meshes: sampling, and its density, which disks and cylinders share. Without the probability of
// selecting the light.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_AREA_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_AREA_LIGHT_INL
#undef KILOBAND_AREA_LIGHT_INL
#else
#define KILOBAND_AREA_LIGHT_INL
#endif

#include <limits>

#include "shared/estimator.h"
#include "src_cpu/geometry/surface_hit-inl.hpp"
#include "src_cpu/lanes/lane_sampler-inl.hpp"
#include "src_cpu/light/light_triangles.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Largest i in [0, count) with cdf[first + i] <= u; intervals of zero width are never chosen. A distribution has
/// count + 1 entries, 0 to 1.
KB_INLINE U find_interval(const float* cdf, U first, U count, F u) {
  U begin = first, length = count;
  while (any(length != (length & U(1u)))) {  // until all are 1, or 0
    const U half = shift_right<1>(length);
    begin = select(gather(cdf, begin + half) <= u, begin + half, begin);
    length = length - half;
  }
  return begin - first;
}

/// Which side of a surface is seen from `away` (a direction away from it): the rule for what area lights
/// emit, what thermal emission and BSDFs are, for hits and light samples alike. Vertex normals decide, not
/// the winding (Mitsuba 3). The media of a surface's sides follow the geometric normal instead: a ray that
/// crosses the surface must find the other medium behind it.
KB_INLINE M on_front(V3 shading_normal, V3 away) {
  return dot(shading_normal, away) > F(0);
}

/// The geometric normal of the side that is seen; 0: it does not emit to there, or is edge-on. Vertex normals
/// may let a triangle shine to the back of its winding: the density goes with the geometric cosine all the same.
KB_INLINE V3 lit_side(U shape_flags, V3 to_light, F distance, V3 geometric_normal, V3 shading_normal) {
  const M faces = has_bits(shape_flags, KB_SHAPE_LIT_BOTH_SIDES) | on_front(shading_normal, -to_light);
  const F away = dot(to_light, geometric_normal);
  const M seen = faces & (abs(away) > F(KB_EDGE_ON) * distance);
  const F sign = select(seen, select(away > F(0), F(-1), F(1)), F(0));
  return geometric_normal * sign;
}

/// Area to solid angle: a point chosen with density 1 / area is seen with density distance^2 / (area cos).
/// to_light  from the shaded point to the light, unnormalised, of length `distance`
/// returns   0 behind the light, where there is no distance, and where the density exceeds the range of float
KB_INLINE F area_to_solid_angle(V3 to_light, F distance, V3 front_normal, F area) {
  const F facing = -dot(to_light, front_normal);  // distance * cos
  const F density = distance * distance * (distance / (facing * area));
  return select((facing > F(0)) & (density < F(kInfinity)), density, F(0));
}

/// In double, as flattening has it: slivers lose no digits.
KB_INLINE F triangle_area(const Triangle& t) {
  const auto edge = [](F to, F from) KB_LAMBDA { return to_doubles(to) - to_doubles(from); };
  const D ax = edge(t.p1.x, t.p0.x), ay = edge(t.p1.y, t.p0.y), az = edge(t.p1.z, t.p0.z);
  const D bx = edge(t.p2.x, t.p0.x), by = edge(t.p2.y, t.p0.y), bz = edge(t.p2.z, t.p0.z);
  const D x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
  return F(0.5f) * to_floats(sqrt(x * x + y * y + z * z));
}

/// A point on an area light as seen from a shaded point: AreaLightSample (area.hpp) in lanes.
struct AreaSample {
  F pdf, factor;
  V3 direction, position, normal;
  F offset;
  V2 uv;
  U triangle;
  V2 barycentric;
};

/// What lights are sampled from.
struct Lights {
  const FlatScene& scene;
  const LightTriangle* triangles =
      nullptr;  // make_light_triangles(), or null; the bits of samples are the same
};

/// A triangle of an area light.
struct LitTriangle {
  Triangle t;
  V3 normal;
  F offset, factor;
};
KB_INLINE LitTriangle gather_lit_triangle(const LightTriangle* triangles, U index) {
  static_assert(offsetof(LightTriangle, normal) == 36 && offsetof(LightTriangle, factor) == 52);
  const TriangleLine line = gather_line(triangles, index);
  const U(&rest)[7] = line.rest;
  return {line.t, as_vector(rest[0], rest[1], rest[2]), as_floats(rest[3]), as_floats(rest[4])};
}
/// The same from the arrays of the scene. area: of the shape
KB_INLINE LitTriangle make_lit_triangle(const FlatScene& scene, U shape_flags, F area, U first_triangle,
                                        U first_cdf, U triangle, M active) {
  U index[3];
  gather_indices(scene, first_triangle, triangle, active, index);
  const float* cdf = scene.area_cdf.data();
  const U at = first_cdf + triangle;
  LitTriangle lit;
  lit.t = gather_triangle(scene, index);
  lit.normal = triangle_normal(lit.t, shape_flags, active);
  lit.offset = surface_offset(largest_coordinates(lit.t), lit.normal);
  lit.factor = triangle_area(lit.t) / area / (gather(cdf, at + U(1u)) - gather(cdf, at));
  return lit;
}

/// A triangle of an emitting mesh that points are sampled on.
struct MeshTriangle {
  U number;    // in the mesh
  F area;      // m^2, by which the density of its points goes
  M by_table;  // chosen by its mesh's table; else by the light tree
};
/// Without a light tree triangles are chosen with the steps that lattice_cdf() gave them, which is their part of the area
/// only up to 2^-24. The density is 1 / area of the mesh, as for hits, so that MIS weights sum to 1;
/// AreaSample::factor is that density over the real one, probability of the triangle / its area.
/// The light tree knows the probability of each triangle.
/// triangle  the tree's choice, KB_NONE: none; area: of it
KB_INLINE MeshTriangle choose_triangle(const FlatScene& scene, const ShapeHead& record, F u, U triangle,
                                       F area, M active) {
  const M by_table = triangle == U(KB_NONE);
  MeshTriangle chosen{triangle, select(by_table, record.area, area), by_table};
  if (!any(active & by_table)) return chosen;
  const U first = select(active, record.first_cdf, U(0u));
  const U count = select(active, record.triangle_count, U(1u));
  chosen.number = select(by_table, find_interval(scene.area_cdf.data(), first, count, u), triangle);
  return chosen;
}

/// record  of an emitting mesh in active lanes
KB_INLINE AreaSample sample_mesh(const Lights& lights, const ShapeHead& record, const MeshTriangle& chosen,
                                 V3 point, F u, F v, bool need_uv, M active) {
  const FlatScene& scene = lights.scene;
  const U first = select(active, record.first_cdf, U(0u));
  const U flags = record.flags;
  AreaSample sample;
  sample.triangle = select(active, chosen.number, U(0u));
  const LitTriangle lit = lights.triangles
                              ? gather_lit_triangle(lights.triangles, first + sample.triangle)
                              : make_lit_triangle(scene, flags, record.area, record.first_triangle, first,
                                                  sample.triangle, active);
  const Triangle& t = lit.t;
  U index[3] = {U(0u), U(0u), U(0u)};
  if (any(active & has_bits(flags, KB_SHAPE_HAS_NORMALS | KB_SHAPE_HAS_UVS)))
    gather_indices(scene, record.first_triangle, sample.triangle, active, index);
  sample.barycentric = uniform_triangle(u, v);
  const V3 weights{F(1) - sample.barycentric.x - sample.barycentric.y, sample.barycentric.x,
                   sample.barycentric.y};
  sample.position = t.p0 + t.e1 * sample.barycentric.x + t.e2 * sample.barycentric.y;
  sample.offset = lit.offset;
  const V3 shading_normal = triangle_shading_normal(scene, flags, index, weights, lit.normal, active);
  const V3 to_light = sample.position - point;
  const F distance = length(to_light);
  sample.normal = lit_side(flags, to_light, distance, lit.normal, shading_normal);
  sample.pdf = select(active, area_to_solid_angle(to_light, distance, sample.normal, chosen.area), F(0));
  sample.direction = to_light * (F(1) / distance);
  sample.factor = select(chosen.by_table, lit.factor, F(1));
  sample.uv = sample.barycentric;  // Mitsuba: barycentric coordinates
  const M has_uvs = active & has_bits(flags, KB_SHAPE_HAS_UVS);
  V3 tangent = lit.normal;
  if (need_uv && any(has_uvs)) triangle_uv(scene, t, index, weights, has_uvs, sample.uv, tangent);
  return sample;
}

/// The density of a hit of a mesh, disk or cylinder whose points are sampled by area.
KB_INLINE F area_density(U shape_flags, F area, V3 geometric_normal, V3 shading_normal, V3 to_light) {
  const F distance = length(to_light);
  return area_to_solid_angle(
      to_light, distance, lit_side(shape_flags, to_light, distance, geometric_normal, shading_normal), area);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
