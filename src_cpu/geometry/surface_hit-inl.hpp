// From a ray hit to the point, its normals, texture coordinates and shading frame.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_SURFACE_HIT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_SURFACE_HIT_INL
#undef KILOBAND_SURFACE_HIT_INL
#else
#define KILOBAND_SURFACE_HIT_INL
#endif

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/geometry/analytic_hit.hpp"
#include "src_cpu/geometry/ray_offset-inl.hpp"
#include "src_cpu/geometry/triangle_records.hpp"
#include "src_cpu/lanes/lane_access-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// SurfaceHit (surface_hit.hpp) in lanes. Lanes that were not asked for are undefined.
struct Hit {
  U shape, shape_flags, surface, emitter;  // emitter: of an area light, or KB_NONE
  V3 point;
  V3 geometric_normal, shading_normal;
  V3 tangent;
  F offset;
  V3 departure;
  V2 uv;
};

/// What hits are made of.
struct Surfaces {
  const FlatScene& scene;
  const TriangleRecord* records;  // make_triangle_records(), or null; the bits of hits are the same
};

KB_INLINE M winding_is_turned(U shape_flags) {
  return has_bits((shape_flags ^ shift_right<5>(shape_flags)) & U(1u), 1u);
}
static_assert(KB_SHAPE_FLIP_NORMALS == 1u && KB_SHAPE_MIRRORED == 32u);

KB_INLINE Triangle triangle_of(V3 p0, V3 p1, V3 p2) {
  const V3 e1 = p1 - p0, e2 = p2 - p0;
  return {p0, p1, p2, e1, e2, cross(e1, e2)};
}
KB_INLINE Triangle gather_triangle(const FlatScene& scene, const U (&index)[3]) {
  const KbFloat3* positions = scene.positions.data();
  return triangle_of(gather_vector(positions, index[0]), gather_vector(positions, index[1]),
                     gather_vector(positions, index[2]));
}

/// Hit::geometric_normal of a triangle.
KB_INLINE V3 triangle_normal(const Triangle& t, U shape_flags, M active) {
  const F turn = select(winding_is_turned(shape_flags), F(-1), F(1));
  const F length2 = dot(t.area_normal, t.area_normal);
  const M tiny = active & !(length2 > F(1e-30f));
  V3 normal = t.area_normal * (turn / sqrt(length2));
  if (any(tiny)) {
    // Tiny triangles: the squared length may underflow where the cross product does not.
    V3Array result(normal), e1(t.e1), e2(t.e2);
    const FloatArray turns(turn);
    each_lane(tiny, [&](uint32_t i) KB_LAMBDA { result.put(i, tiny_normal(e1[i], e2[i]) * turns[i]); });
    normal = result;
  }
  return normal;
}

/// Both matrices of the instances that some lanes have hit.
struct InstancePlacement {
  M lanes;
  F to_world[12], to_object[12];
};
KB_INLINE InstancePlacement gather_placement(const FlatScene& scene, U shape, M lanes) {
  static_assert(offsetof(KbShape, to_world) == 32 && offsetof(KbShape, to_object) == 80);
  const Addresses records(scene.shapes.data(), select(lanes, shape, U(0u)));
  InstancePlacement placement;
  placement.lanes = lanes;
  for (std::size_t row = 0; row < 3; ++row) {
    U words[4];
    records.load(32 + 16 * row, words);
    for (std::size_t i = 0; i < 4; ++i) placement.to_world[4 * row + i] = as_floats(words[i]);
    records.load(80 + 16 * row, words);
    for (std::size_t i = 0; i < 4; ++i) placement.to_object[4 * row + i] = as_floats(words[i]);
  }
  return placement;
}
/// By the transposed linear part: normals, by the inverse of what maps points.
KB_INLINE V3 transformed_normal(const F (&m)[12], V3 n) {
  return {m[0] * n.x + m[4] * n.y + m[8] * n.z, m[1] * n.x + m[5] * n.y + m[9] * n.z,
          m[2] * n.x + m[6] * n.y + m[10] * n.z};
}
/// By the absolute values of the linear part.
KB_INLINE V3 transformed_size(const F (&m)[12], V3 v) {
  return {abs(m[0]) * v.x + abs(m[1]) * v.y + abs(m[2]) * v.z,
          abs(m[4]) * v.x + abs(m[5]) * v.y + abs(m[6]) * v.z,
          abs(m[8]) * v.x + abs(m[9]) * v.y + abs(m[10]) * v.z};
}

/// Hit::shading_normal at a point of a triangle: weights of its corners; lanes without vertex normals get the
/// geometric one. placement: of instances, or null
KB_INLINE V3 triangle_shading_normal(const FlatScene& scene, U shape_flags, const U (&index)[3], V3 weights,
                                     V3 geometric_normal, M active,
                                     const InstancePlacement* placement = nullptr) {
  const M has_normals = active & has_bits(shape_flags, KB_SHAPE_HAS_NORMALS);
  if (!any(has_normals)) return geometric_normal;
  const auto normal = [&](int k) KB_LAMBDA {
    return gather_vector(scene.normals.data(), select(has_normals, index[k], U(0u)));
  };
  V3 n = normal(0) * weights.x + normal(1) * weights.y + normal(2) * weights.z;
  if (placement) n = select(placement->lanes, transformed_normal(placement->to_object, n), n);
  const F n2 = dot(n, n);
  const F turn = select(has_bits(shape_flags, KB_SHAPE_FLIP_NORMALS), F(-1), F(1));
  return select(has_normals & (n2 > F(0)), n * (turn / sqrt(n2)), geometric_normal);
}

/// Texture coordinates of a triangle's corners, and what the edges' are from the first one on.
struct TriangleUvs {
  V2 uv0, uv1, uv2;
  F du1, dv1, du2, dv2, determinant;

  /// dp/du and dp/dv; infinite or NaN where the determinant is 0
  KB_INLINE V3 along_u(V3 e1, V3 e2) const { return (e1 * dv2 - e2 * dv1) / determinant; }
  KB_INLINE V3 along_v(V3 e1, V3 e2) const { return (e2 * du1 - e1 * du2) / determinant; }
};
KB_INLINE TriangleUvs gather_uvs(const FlatScene& scene, const U (&index)[3], M has_uvs) {
  const auto corner = [&](int k) KB_LAMBDA {
    return gather_pair(scene.uvs.data(), select(has_uvs, index[k], U(0u)));
  };
  TriangleUvs t;
  t.uv0 = corner(0), t.uv1 = corner(1), t.uv2 = corner(2);
  t.du1 = t.uv1.x - t.uv0.x, t.dv1 = t.uv1.y - t.uv0.y, t.du2 = t.uv2.x - t.uv0.x, t.dv2 = t.uv2.y - t.uv0.y;
  t.determinant = t.du1 * t.dv2 - t.dv1 * t.du2;
  return t;
}

/// dp/du of triangles with texture coordinates, zero where they are degenerate; and the texture coordinates.
KB_INLINE void triangle_uv(const FlatScene& scene, const Triangle& t, const U (&index)[3], V3 weights,
                           M has_uvs, V2& uv, V3& tangent) {
  const TriangleUvs uvs = gather_uvs(scene, index, has_uvs);
  uv.x = select(has_uvs, weights.x * uvs.uv0.x + weights.y * uvs.uv1.x + weights.z * uvs.uv2.x, uv.x);
  uv.y = select(has_uvs, weights.x * uvs.uv0.y + weights.y * uvs.uv1.y + weights.z * uvs.uv2.y, uv.y);
  tangent = select(has_uvs & (uvs.determinant != F(0)), uvs.along_u(t.e1, t.e2), tangent);
}

/// The members of KbShape before its matrices.
struct ShapeHead {
  U type, flags, surface, emitter, first_triangle, triangle_count, first_cdf;
  F area;
};
KB_INLINE ShapeHead gather_shape(const FlatScene& scene, U shape) {
  static_assert(offsetof(KbShape, emitter) == 12 && offsetof(KbShape, area) == 28);
  const Addresses records(scene.shapes.data(), shape);
  U a[4], b[4];
  records.load(0, a);
  records.load(16, b);
  return {a[0], a[1], a[2], a[3], b[0], b[1], b[2], as_floats(b[3])};
}

/// Of a shape that all lanes have.
KB_INLINE ShapeHead shared_shape(const KbShape& shape) {
  return {U(shape.type),           U(shape.flags),          U(shape.surface),   U(shape.emitter),
          U(shape.first_triangle), U(shape.triangle_count), U(shape.first_cdf), F(shape.area)};
}

/// The vertices of triangle `primitive` of a shape.
KB_INLINE void gather_indices(const FlatScene& scene, U first_triangle, U primitive, M active,
                              U (&index)[3]) {
  gather_triple(scene.triangles.data(), select(active, first_triangle + primitive, U(0u)), index);
}

/// A record of one cache line that begins with a triangle's corners.
struct TriangleLine {
  Triangle t;
  U rest[7];
};
template <class Record>
KB_INLINE TriangleLine gather_line(const Record* records, U index) {
  static_assert(sizeof(Record) == 64 && sizeof(Record::corners) == 36 && offsetof(Record, corners) == 0);
  const Addresses at(records, index);
  U a[4], b[4], c[4], d[4];
  at.load(0, a);
  at.load(16, b);
  at.load(32, c);
  at.load(48, d);
  return {triangle_of(as_vector(a[0], a[1], a[2]), as_vector(a[3], b[0], b[1]), as_vector(b[2], b[3], c[0])),
          {c[1], c[2], c[3], d[0], d[1], d[2], d[3]}};
}

/// A triangle that was hit.
struct HitTriangle {
  Triangle t;
  U vertices[3];
  V3 normal;
  F offset;
};
KB_INLINE HitTriangle gather_record(const TriangleRecord* records, U index) {
  static_assert(offsetof(TriangleRecord, vertices) == 36 && offsetof(TriangleRecord, normal) == 48);
  const TriangleLine line = gather_line(records, index);
  const U(&rest)[7] = line.rest;
  return {line.t, {rest[0], rest[1], rest[2]}, as_vector(rest[3], rest[4], rest[5]), as_floats(rest[6])};
}
/// The same without records.
KB_INLINE HitTriangle gather_hit_triangle(const FlatScene& scene, U shape_flags, U index, M active) {
  HitTriangle hit;
  gather_triple(scene.triangles.data(), index, hit.vertices);
  hit.t = gather_triangle(scene, hit.vertices);
  hit.normal = triangle_normal(hit.t, shape_flags, active);
  hit.offset = surface_offset(largest_coordinates(hit.t), hit.normal);
  return hit;
}

/// Instances: from their own coordinates into the world. Rays were brought to them by to_object: what that and back
/// again may be wrong by counts for offsets as the coordinates themselves do (ray_offset-inl.hpp), which is
/// |to_world| |to_object| times the largest of them and of the instance's place.
KB_INLINE void place_triangle(const InstancePlacement& placement, U shape_flags, HitTriangle& on) {
  const M lanes = placement.lanes;
  const auto place = [&](V3 p) KB_LAMBDA { return select(lanes, transform_point(placement.to_world, p), p); };
  on.t = triangle_of(place(on.t.p0), place(on.t.p1), place(on.t.p2));
  on.normal = select(lanes, triangle_normal(on.t, shape_flags, lanes), on.normal);
  const V3 corners = largest_coordinates(on.t);
  const V3 reach = {max(corners.x, abs(placement.to_world[3])), max(corners.y, abs(placement.to_world[7])),
                    max(corners.z, abs(placement.to_world[11]))};
  const V3 there_and_back =
      transformed_size(placement.to_world, transformed_size(placement.to_object, reach));
  on.offset = select(lanes, surface_offset(there_and_back, on.normal), on.offset);
}

/// triangle  of those of the scene
KB_INLINE void make_mesh_hit(const Surfaces& surfaces, U triangle, F u, F v, M active, Hit& hit) {
  const FlatScene& scene = surfaces.scene;
  const U safe = select(active, triangle, U(0u));
  HitTriangle on = surfaces.records ? gather_record(surfaces.records, safe)
                                    : gather_hit_triangle(scene, hit.shape_flags, safe, active);
  InstancePlacement placement;
  const InstancePlacement* placed = nullptr;
  if (scene.features.instances) {
    const M lanes = active & has_bits(hit.shape_flags, KB_SHAPE_INSTANCED);
    if (any(lanes)) {
      placement = gather_placement(scene, hit.shape, lanes);
      place_triangle(placement, hit.shape_flags, on);
      placed = &placement;
    }
  }
  const Triangle& t = on.t;
  const V3 weights{F(1) - u - v, u, v};
  hit.point = t.p0 * weights.x + t.p1 * weights.y + t.p2 * weights.z;
  hit.geometric_normal = on.normal;
  hit.offset = on.offset;
  hit.departure = off_the_edges(t, hit.point, weights, hit.offset, active);
  hit.shading_normal = triangle_shading_normal(scene, hit.shape_flags, on.vertices, weights,
                                               hit.geometric_normal, active, placed);
  hit.uv = {u, v};
  hit.tangent = {F(0), F(0), F(0)};
  const M has_uvs = active & has_bits(hit.shape_flags, KB_SHAPE_HAS_UVS);
  if (any(has_uvs)) triangle_uv(scene, t, on.vertices, weights, has_uvs, hit.uv, hit.tangent);
}

/// Spheres, disks and cylinders are few, and their geometry is in double: one lane after another.
inline void make_analytic_hits(const FlatScene& scene, V3 origin, V3 direction, F distance, M active,
                               Hit& hit) {
  V3Array point(hit.point), normal(hit.geometric_normal), shading(hit.shading_normal), tangent(hit.tangent);
  V3Array departure(hit.departure);
  FloatArray offset(hit.offset), u(hit.uv.x), v(hit.uv.y);
  const V3Array from(origin), along(direction);
  const FloatArray t(distance);
  const WordArray shape(hit.shape);
  each_lane(active, [&](uint32_t i) KB_LAMBDA {
    const AnalyticHit one = analytic_hit(scene.shapes[shape[i]], from[i], along[i], t[i]);
    point.put(i, one.surface.position);
    normal.put(i, one.surface.normal);
    shading.put(i, one.surface.normal);
    tangent.put(i, one.surface.tangent);
    departure.put(i, one.departure);
    offset[i] = one.offset;
    u[i] = one.surface.uv.x, v[i] = one.surface.uv.y;
  });
  hit.point = point;
  hit.geometric_normal = normal;
  hit.shading_normal = shading;
  hit.tangent = tangent;
  hit.offset = offset;
  hit.departure = departure;
  hit.uv = {u, v};
}

/// The surfaces that rays have hit. Meshes: by their barycentric coordinates; analytic shapes: from
/// origin + distance * direction.
KB_INLINE void make_hit(const Surfaces& surfaces, U shape, U primitive, F u, F v, V3 origin, V3 direction,
                        F distance, M active, Hit& hit) {
  const FlatScene& scene = surfaces.scene;
  hit.shape = select(active, shape, U(0u));
  const ShapeHead record = gather_shape(scene, hit.shape);
  hit.shape_flags = record.flags;
  hit.surface = record.surface;
  hit.emitter = record.emitter;
  const U triangle = record.first_triangle + primitive;
  if (kLanes > 1 && !scene.features.analytic_shapes)  // one lane asks for its shape alone
    return make_mesh_hit(surfaces, triangle, u, v, active, hit);
  const M mesh = active & (record.type == U(KB_SHAPE_MESH));
  hit.point = hit.geometric_normal = hit.shading_normal = hit.tangent = hit.departure = {F(0), F(0), F(0)};
  hit.offset = hit.uv.x = hit.uv.y = F(0);
  if (any(mesh)) make_mesh_hit(surfaces, triangle, u, v, mesh, hit);
  if (any(active & !mesh)) make_analytic_hits(scene, origin, direction, distance, active & !mesh, hit);
}

/// Asks for the records of triangles before they are needed.
KB_INLINE void prefetch_records(const Surfaces& surfaces, U shape, U primitive, M active) {
  const M hit = active & (shape != U(KB_NONE));
  const U safe = select(hit, shape, U(0u));
  const U first = KB_GATHER_WORD(surfaces.scene.shapes.data(), KbShape, first_triangle, safe);
  const WordArray triangle(select(hit, first + primitive, U(0u)));
  for (uint32_t i = 0; i < kLanes; ++i) __builtin_prefetch(surfaces.records + triangle[i]);
}

/// Orthonormal frame with z = shading normal; x along the tangent where there is one (anisotropic roughness).
struct Frame {
  V3 x, y, z;

  KB_INLINE V3 to_local(V3 w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
  KB_INLINE V3 to_world(V3 w) const { return x * w.x + y * w.y + z * w.z; }
};

/// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
KB_INLINE Frame make_frame(V3 normal) {
  const F sign = copysign(F(1), normal.z);
  const F a = F(-1) / (sign + normal.z), b = normal.x * normal.y * a;
  return {{F(1) + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
          {b, sign + normal.y * normal.y * a, -normal.y},
          normal};
}

KB_INLINE Frame make_frame(V3 normal, V3 tangent) {
  const V3 along = tangent - normal * dot(normal, tangent);
  const F length2 = dot(along, along);
  // Of a tangent along the normal only rounding is left: no direction to go by.
  const M tangential = length2 > F(1e-6f) * dot(tangent, tangent);
  const Frame any_frame = make_frame(normal);
  const V3 x = along / sqrt(length2);
  return {select(tangential, x, any_frame.x), select(tangential, cross(normal, x), any_frame.y), normal};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
