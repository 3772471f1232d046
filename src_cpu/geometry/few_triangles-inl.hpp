// Rays against a list of triangles (few_triangles.hpp).
//
// Corners are seen from the ray: x and y across it, in a frame whose z is its direction. A triangle (A, B, C) is crossed where the
// ray, (0, 0) in that plane, is on one side of its edges:
//   U = C x B, V = A x C, W = B x A (two-dimensional, up to a sign), all of one sign or zero.
// Two triangles with an edge in common have the same products there with signs exchanged, and a difference of rounded products has
// the sign of the exact one or is zero: no ray passes between them, nor through a corner (after Woop, Benthin and Wald 2013, "Watertight
// Ray/Triangle Intersection", whose frame is a shear). The distance is that of the plane, A . n / (d . n): A is as exact as
// the difference of two floats, so that rays that begin off a triangle (ray_offset-inl.hpp) do not find it. With
// d . n = -(U + V + W) / |(B - A) x (C - A)| for a unit d, fractions are compared by cross products: one division a ray, not a triangle.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_FEW_TRIANGLES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_FEW_TRIANGLES_INL
#undef KILOBAND_FEW_TRIANGLES_INL
#else
#define KILOBAND_FEW_TRIANGLES_INL
#endif

#include <cstddef>

#include "src_cpu/geometry/few_triangles.hpp"
#include "src_cpu/geometry/ray_queue.hpp"
#include "src_cpu/geometry/surface_hit-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// Where rays cross a triangle's plane within it: after along / cosine m, either of which side.
struct Crossing {
  M lanes;
  F along, cosine;  // m; of the angle to the normal, not negative
  F v, w, all;      // of the corners' weights: V, W and U + V + W
};

/// Calls visit(triangle, crossing) for the triangles that the line of one of the rays crosses.
/// length  of the directions
template <class Visit>
KB_INLINE void each_crossing(const FewTriangles& few, V3 origin, V3 direction, F length, const Visit& visit) {
  F x[kMostFewCorners], y[kMostFewCorners];
  const Frame frame = make_frame(direction * (F(1) / length));
  const auto from_origin = [&](const KbFloat3& p) KB_LAMBDA { return V3{F(p.x), F(p.y), F(p.z)} - origin; };
  for (std::size_t i = 0; i < few.corners.size(); ++i) {
    const V3 corner = from_origin(few.corners[i]);
    x[i] = dot(corner, frame.x), y[i] = dot(corner, frame.y);
  }
  for (uint32_t i = 0; i < few.triangles.size(); ++i) {
    const FewTriangles::Triangle& t = few.triangles[i];
    const auto [a, b, c] = t.corners;
    const F u = x[c] * y[b] - y[c] * x[b], v = x[a] * y[c] - y[a] * x[c], w = x[b] * y[a] - y[b] * x[a];
    const M inside = (min(min(u, v), w) >= F(0)) | (max(max(u, v), w) <= F(0));
    if (!any(inside)) continue;
    const F all = u + v + w;
    const F height = dot(from_origin(few.corners[a]), V3{F(t.normal[0]), F(t.normal[1]), F(t.normal[2])});
    visit(i, Crossing{inside, select(all < F(0), height, -height), abs(all) * F(t.inverse_area2), v, w, all});
  }
}

/// Answers `rays` as RayQueue says.
inline void closest_of_few(const FewTriangles& few, RayQueue& rays) {
  const FewTriangles::Triangle* const triangles = few.triangles.data();
  for (uint32_t first = 0; first < rays.count; first += kLanes) {
    const V3 direction{load(rays.dx + first), load(rays.dy + first), load(rays.dz + first)};
    const F far_end = load(rays.t_max + first), ray_length = length(direction);
    const F near_along = load(rays.t_min + first) * ray_length;
    F along = far_end * ray_length, cosine(1), v(0), w(0), all(1);
    U closest(KB_NONE);
    each_crossing(few, {load(rays.ox + first), load(rays.oy + first), load(rays.oz + first)}, direction,
                  ray_length, [&](uint32_t triangle, const Crossing& at) KB_LAMBDA {
                    const M nearer = at.lanes & (at.along > near_along * at.cosine) &
                                     (at.along * cosine < along * at.cosine);
                    along = select(nearer, at.along, along);
                    cosine = select(nearer, at.cosine, cosine);
                    v = select(nearer, at.v, v);
                    w = select(nearer, at.w, w);
                    all = select(nearer, at.all, all);
                    closest = select(nearer, U(triangle), closest);
                  });
    const M hit = closest != U(KB_NONE);
    const U safe = select(hit, closest, U(0u));
    const U shape = KB_GATHER_WORD(triangles, FewTriangles::Triangle, shape, safe);
    store(select(hit, along / (cosine * ray_length), far_end), rays.t_max + first);
    store(v / all, rays.u + first);
    store(w / all, rays.v + first);
    store(KB_GATHER_WORD(triangles, FewTriangles::Triangle, primitive, safe), rays.primitive + first);
    store(select(hit, shape, U(KB_NONE)), rays.shape + first);
  }
  end_lanes();
}

/// Answers `rays` as ShadowQueue says.
inline void occlusions_of_few(const FewTriangles& few, ShadowQueue& rays) {
  for (uint32_t first = 0; first < rays.count; first += kLanes) {
    const V3 direction{load(rays.dx + first), load(rays.dy + first), load(rays.dz + first)};
    const F far_end = load(rays.t_max + first), ray_length = length(direction),
            far_along = far_end * ray_length;
    M between = no_lanes();
    each_crossing(few, {load(rays.ox + first), load(rays.oy + first), load(rays.oz + first)}, direction,
                  ray_length, [&](uint32_t, const Crossing& at) KB_LAMBDA {
                    between = between | (at.lanes & (at.along > F(0)) & (at.along < far_along * at.cosine));
                  });
    store(select(between, F(-1), far_end), rays.t_max + first);
  }
  end_lanes();
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
