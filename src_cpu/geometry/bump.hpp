// Bump and normal maps: the shading frame that a texture turns. Few surfaces have them, so one path at a time.
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
#pragma once

#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// A point that was hit.
struct BumpPoint {
  uint32_t shape, primitive;
  glm::vec2 uv;
  glm::vec3 normal;  // n
  glm::vec3 away;    // towards where the path comes from
  bool turned;       // a two-sided surface seen from behind
};

constexpr float kNotBumped = -1;
struct BumpedNormal {
  glm::vec3 normal;           // n', on n's side: turned surfaces take its negative
  float alpha2 = kNotBumped;  // of the masking function; 0: none
  bool mapped = false;        // by a normal map
};
BumpedNormal bumped_normal(const FlatScene& scene, const KbBump& bump, const BumpPoint& at);

}  // namespace kiloband::cpu
