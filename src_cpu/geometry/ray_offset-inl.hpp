// Where a ray leaves a surface: off it by an amount that follows floating point precision, not the scene's size.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_RAY_OFFSET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_RAY_OFFSET_INL
#undef KILOBAND_RAY_OFFSET_INL
#else
#define KILOBAND_RAY_OFFSET_INL
#endif

#include "src_cpu/lanes/vector3-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// How far off a surface rays begin, in m: far enough that a ray from there does not find the surface it left.
///
/// With u = 2^-24, a point on a triangle and the plane through it that an intersection test sees are wrong by
/// a few u times the corners' coordinates, each in its axis' share of the normal: a level plane is exact,
/// however wide, where its height is. Tests that turn the triangle into the ray's frame mix the axes: another
/// u or two of the largest coordinate. With squares from 1e-6 to 1e4 m (tests/unit/src_cpu/light,
/// validation/suite: all_sizes) an eighth of the factor along the normal still sufficed; the factor across
/// has no measured lower bound. The coordinates of the POINT do not enter: a large triangle is as imprecise
/// near the origin as elsewhere, and a small one there as precise as its corners.
/// largest_coordinates  per axis: the largest |coordinate| of what the point lies on
KB_INLINE F surface_offset(V3 largest_coordinates, V3 unit_normal) {
  constexpr float kAlongNormal = 1.0f / 524288.0f, kAcross = 1.0f / 4194304.0f;  // 2^-19, 2^-22
  const F along = dot(abs(unit_normal), largest_coordinates);
  return F(kAlongNormal) * along + F(kAcross) * largest(largest_coordinates);
}

/// How far before a light's surface a shadow ray ends: the test of its triangle is as wrong as above, and by
/// the distance besides.
KB_INLINE F target_offset(F offset, V3 to_light) {
  return offset + F(1.0f / 1048576.0f) * largest(abs(to_light));  // 2^-20
}

/// The point from which a ray towards `direction` leaves a surface: off it, on the side that the ray goes to.
KB_INLINE V3 leave_surface(V3 departure, V3 geometric_normal, F offset, V3 direction) {
  return departure + geometric_normal * select(dot(geometric_normal, direction) >= F(0), offset, -offset);
}

/// A triangle by its corners and edges from the first one.
struct Triangle {
  V3 p0, p1, p2, e1, e2;
  V3 area_normal;  // cross product of the edges: twice the area long
};

KB_INLINE V3 largest_coordinates(const Triangle& t) {
  const V3 a = abs(t.p0), b = abs(t.p1), c = abs(t.p2);
  return {max(max(a.x, b.x), c.x), max(max(a.y, b.y), c.y), max(max(a.z, b.z), c.z)};
}

/// The seldom part of off_the_edges(). area2: twice the triangle's area; least: distance from the edges, m
inline V3 moved_off_the_edges(const Triangle& t, V3 p, F area2, F least) {
  const V3 corners[3] = {t.p0, t.p1, t.p2};
  V3 moved = p;
  F share(0), near(0);  // share: of the way to the centroid
  for (int i = 0; i < 3; ++i) {
    const V3 edge = corners[(i + 1) % 3] - corners[i];
    const F edge_length = length(edge), height = area2 / edge_length;
    const V3 inwards = cross(t.area_normal, edge) / (area2 * edge_length);
    const F wanted = min(least, height / F(8)), missing = wanted - dot(p - corners[i], inwards);
    const M too_near = missing > F(0);
    near = near + select(too_near, F(1), F(0));
    moved = select(too_near, p + inwards * missing, moved);
    // The centroid is a third high.
    share = select(too_near, max(share, missing / (missing + height / F(3) - wanted)), share);
  }
  const V3 inside = p + ((t.p0 + t.p1 + t.p2) / F(3) - p) * share;
  return select(area2 > F(0), select(near > F(1), inside, moved), p);
}

/// A point of a triangle, moved in its plane to at least 8 offsets from its edges (in slivers an eighth of
/// the height). A point that is rounded across an edge lies outside of the neighbour, and a ray from there
/// leaves a closed body unseen; so does one that is moved off the triangle next to a neighbour at an acute
/// angle (up to atan(1/8) = 7 degrees). Without this, 1 of 10^6 to 10^8 rays left such bodies.
/// weights  barycentric, of the three corners
KB_INLINE V3 off_the_edges(const Triangle& t, V3 p, V3 weights, F offset, M active) {
  const F least = F(8) * offset, smallest = min(min(weights.x, weights.y), weights.z);
  const F area2_squared = dot(t.area_normal, t.area_normal);
  // The distance from an edge is weight * area2 / its length; the third edge, squared, is at most this long.
  const F long2 = F(2) * (dot(t.e1, t.e1) + dot(t.e2, t.e2));
  const M far =
      (smallest > F(0)) & (smallest * smallest * area2_squared > least * least * long2);  // nearly always
  if (!any(active & !far)) return p;
  return select(far, p, moved_off_the_edges(t, p, sqrt(area2_squared), least));
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
