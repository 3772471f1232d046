// Bump and normal maps: the shading frame that a texture turns.
//
// n: the shading normal; p_u, p_v: dp/du, dp/dv of the surface; h(u, v): the texture's height in m. The displaced surface
// p + h n has, where n is taken as constant and what of p_u and p_v stands along n is left out (it is that of the flat
// triangle under interpolated normals), the tangents
//   q_u = p_u - n (n . p_u) + n h_u,   q_v = p_v - n (n . p_v) + n h_v,
// and the normal n' along q_u x q_v. Its part along n is that of p_u x p_v: whatever the slope, n' . n > 0 once n' is turned to n's
// side. h is the bilinear interpolation of texels, h_u and h_v its derivatives: constant along u within a cell, 0
// of a nearest texel and where clamping or mirroring repeats a texel.
//
// A normal map has n' itself, (x, y, z) = 2 rgb - 1 interpolated and normalised, in the frame s along p_u - n (n . p_u), t = n x s, n.
// n' . n may be negative there. Anisotropic materials have their tangent along s - n' (n' . s), as in Mitsuba 3.9.1; of a bump map,
// whose frames there depend on the axes of the world, along p_u - n' (n' . p_u).
//
// What is done with n' is Mitsuba 3.9.1's, observed with its eval() and sample():
// * KB_BUMP_FLIP: where n and n' see the direction w that the path comes from on different sides, (w . n) (w . n') <= 0, n' is
//   replaced by 2 (n . n') n - n', n' turned half around n.
// * From behind a two-sided surface shows the same bumps as from the front: the normal is n' - 2 (n . n') n. With KB_BUMP_OUTSIDE it
//   is -n', bumps seen from behind are dents.
// * A direction that n and n' see on different sides carries nothing.
// * KB_BUMP_SHADOW: the value is multiplied by a masking function of the angle between n and the direction of light (Estevez,
//   Lecocq, Fajardo, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem", Ray Tracing Gems 2019):
//   2 / (1 + sqrt(1 + alpha^2 tan^2 theta)), alpha^2 = tan^2(n, n') / 8, at most 1.
// Where n' = n exactly nothing of this is done, and the surface has the bits of one without a map.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_BUMP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_BUMP_INL
#undef KILOBAND_BUMP_INL
#else
#define KILOBAND_BUMP_INL
#endif

#include "src_cpu/geometry/shape_geometry.hpp"
#include "src_cpu/geometry/surface_hit-inl.hpp"
#include "src_cpu/geometry/texture/texture-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// Points that were hit.
struct BumpPlace {
  U shape, primitive;
  V2 uv;
  V3 normal;  // n
  V3 away;    // towards where the path comes from
  M turned;   // a two-sided surface seen from behind
};

inline constexpr float kNotBumped = -1;
struct BumpedNormal {
  V3 normal;  // n', on n's side: turned surfaces take its negative
  F alpha2;   // of the masking function; 0: none; kNotBumped where n' = n
  M mapped;   // by a normal map
};

// ---- the surface ---------------------------------------------------------------------------------------

/// dp/du, dp/dv; where a mesh has no texture coordinates, its barycentric ones take their place. Zero where they are degenerate.
struct LaneTangents {
  V3 du, dv;
};

KB_INLINE LaneTangents mesh_tangents(const FlatScene& scene, const BumpPlace& at, const ShapeHead& shape,
                                     M active) {
  U index[3];
  gather_indices(scene, shape.first_triangle, at.primitive, active, index);
  const Triangle t = gather_triangle(scene, index);
  V3 e1 = t.e1, e2 = t.e2;
  if (const M instanced = active & has_bits(shape.flags, KB_SHAPE_INSTANCED); any(instanced)) {
    const InstancePlacement placement = gather_placement(scene, at.shape, instanced);
    e1 = select(instanced, transform_vector(placement.to_world, e1), e1);
    e2 = select(instanced, transform_vector(placement.to_world, e2), e2);
  }
  const M has_uvs = active & has_bits(shape.flags, KB_SHAPE_HAS_UVS);
  if (!any(has_uvs)) return {e1, e2};
  const TriangleUvs uvs = gather_uvs(scene, index, has_uvs);
  const M degenerate = uvs.determinant == F(0);
  const V3 zero{F(0), F(0), F(0)};
  return {select(has_uvs, select(degenerate, zero, uvs.along_u(e1, e2)), e1),
          select(has_uvs, select(degenerate, zero, uvs.along_v(e1, e2)), e2)};
}

inline LaneTangents surface_tangents(const FlatScene& scene, const BumpPlace& at, M active) {
  const ShapeHead shape = gather_shape(scene, select(active, at.shape, U(0u)));
  const M mesh = active & (shape.type == U(KB_SHAPE_MESH));
  LaneTangents tangents{};
  if (any(mesh)) tangents = mesh_tangents(scene, at, shape, mesh);
  if (const M analytic = active & !mesh; any(analytic)) {  // few, and with sines: one lane after another
    V3Array du(tangents.du), dv(tangents.dv);
    const WordArray shapes(at.shape);
    const FloatArray u(at.uv.x), v(at.uv.y);
    each_lane(analytic, [&](uint32_t i) KB_LAMBDA {
      const AnalyticTangents one = analytic_tangents(scene.shapes[shapes[i]], {u[i], v[i]});
      du.put(i, one.du);
      dv.put(i, one.dv);
    });
    tangents = {du, dv};
  }
  return tangents;
}

// ---- heights -------------------------------------------------------------------------------------------

/// The derivative of a lookup's place among texels by the coordinate x in texels: texels are stored in ascending order, in mirrored
/// images too.
KB_INLINE F axis_slope(D x, F size, U wrap) {
  const F near = to_floats(x), last = size - F(1);
  const M inside = (near > F(0)) & (to_floats(x - to_doubles(last)) < F(0));
  const F i = wrap_period(floor(usable(x)), F(2) * size);
  const M moves = (abs(near) < F(KB_LARGEST_COORDINATE)) & (i != last) & (i != F(2) * size - F(1));
  const F mirrored = select(moves, select(i < last, F(1), F(-1)), F(0));
  const F clamped = select(inside, F(1), F(0));
  return select(wrap == U(KB_WRAP_REPEAT), F(1), select(wrap == U(KB_WRAP_CLAMP), clamped, mirrored));
}

/// dh/du, dh/dv of textures of heights.
KB_INLINE V2 height_gradient(const FlatScene& scene, const Textures& textures, U index, V2 uv, M active) {
  const TextureSample s = sample_bitmaps(textures, index, uv, active);
  const CornerBounds height(scene, textures, select(active, s.xy, U(0u)));
  const F(&h)[4] = height.at;
  const F columns = to_floats(textures.width), rows = to_floats(textures.height), (&m)[6] = textures.to_uv;
  const D half = to_doubles(0.5);
  const F x = axis_slope(row_of_uv(m, uv) * to_doubles(columns) - half, columns, textures.wrap) * columns *
              ((F(1) - s.fy) * (h[1] - h[0]) + s.fy * (h[3] - h[2]));
  const F y = axis_slope(row_of_uv(m + 3, uv) * to_doubles(rows) - half, rows, textures.wrap) * rows *
              ((F(1) - s.fx) * (h[2] - h[0]) + s.fx * (h[3] - h[1]));
  const M varies = active & !has_bits(textures.flags, KB_TEXTURE_NEAREST);
  return {select(varies, x * m[0] + y * m[3], F(0)), select(varies, x * m[1] + y * m[4], F(0))};
}

/// Of a vector that may be so long or short that its square is not.
KB_INLINE V3 brought_to_one(V3 v) {
  return v / largest(abs(v));
}

KB_INLINE V3 height_normal(const BumpPlace& at, const LaneTangents& p, V2 slope, M active) {
  const V3 n = at.normal;
  const V3 q = cross(brought_to_one(p.du + n * (slope.x - dot(n, p.du))),
                     brought_to_one(p.dv + n * (slope.y - dot(n, p.dv))));
  const F length2 = dot(q, q), along = dot(q, n);
  const M slopes = active & ((slope.x != F(0)) | (slope.y != F(0)));
  const M stands = slopes & (length2 > F(0)) & (along != F(0));  // else: no tangents, or parallel ones
  return select(stands, q * (select(along < F(0), F(-1), F(1)) / sqrt(length2)), n);
}

// ---- normals -------------------------------------------------------------------------------------------

KB_INLINE V3 mapped_normal(const FlatScene& scene, const Textures& textures, U index, const BumpPlace& at,
                           const LaneTangents& p, M active) {
  const TextureSample s = sample_bitmaps(textures, index, at.uv, active);
  const Corners corners = corners_of(textures, textures.first_texel, s.xy);
  V3 local{F(0), F(0), F(0)};
  for (uint32_t corner = 0; corner < 4; ++corner) {
    U texel[4];
    Addresses(scene.texels.data(), select(active, corners.at[corner], U(0u))).load(0, texel);
    const F share = (corner & 1 ? s.fx : F(1) - s.fx) * (corner & 2 ? s.fy : F(1) - s.fy);
    local = local + as_vector(texel[0], texel[1], texel[2]) * share;
  }
  const F length2 = dot(local, local);
  const M straight = (local.x == F(0)) & (local.y == F(0)) & (local.z > F(0));
  const Frame frame = make_frame(at.normal, p.du);
  return select(active & (length2 > F(0)) & !straight, frame.to_world(local / sqrt(length2)), at.normal);
}

/// n' turned half around n.
KB_INLINE V3 half_turned(V3 n, V3 bumped) {
  return n * (F(2) * dot(n, bumped)) - bumped;
}

/// bump  index of a KbBump
inline BumpedNormal bumped_normals(const FlatScene& scene, U bump, const BumpPlace& at, M active) {
  const U texture = KB_GATHER_WORD(scene.bumps.data(), KbBump, texture, bump);
  const U flags = KB_GATHER_WORD(scene.bumps.data(), KbBump, flags, bump);
  const M bumps = active & (texture != U(KB_NONE));
  if (!any(bumps)) return {at.normal, F(kNotBumped), bumps};
  const Textures textures = textures_of(scene, texture, bumps);
  const LaneTangents tangents = surface_tangents(scene, at, bumps);
  const M mapped = bumps & has_bits(textures.flags, KB_TEXTURE_NORMALS), raised = bumps & !mapped;
  const V3 n = at.normal;
  V3 normal = n;
  if (any(raised))
    normal = height_normal(at, tangents, height_gradient(scene, textures, texture, at.uv, raised), raised);
  if (any(mapped))
    normal = select(mapped, mapped_normal(scene, textures, texture, at, tangents, mapped), normal);
  const M turns = bumps & ((normal.x != n.x) | (normal.y != n.y) | (normal.z != n.z));
  normal = select(at.turned & !has_bits(flags, KB_BUMP_OUTSIDE), half_turned(n, normal), normal);
  const M parted = dot(at.away, n) * dot(at.away, normal) <= F(0);
  normal = select(parted & has_bits(flags, KB_BUMP_FLIP), half_turned(n, normal), normal);
  const F cosine = dot(n, normal), cos2 = min(cosine * cosine, F(1));
  const F alpha2 = min(F(0.125f) * (F(1) - cos2) / max(cos2, F(1e-6f)), F(1));
  return {select(turns, normal, n),
          select(turns, select(has_bits(flags, KB_BUMP_SHADOW), alpha2, F(0)), F(kNotBumped)),
          mapped & turns};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
