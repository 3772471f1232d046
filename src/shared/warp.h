// Maps from uniform random numbers to directions and positions, with their densities.
//
// u, v are uniform in [0, 1). Directions are unit vectors of a local frame, z up. Densities are per solid
// angle [1/sr] or per area of the unit disk. Including this header brings in fresnel.h, microfacet.h and
// filter_sample.h.
// Sources: Shirley, Chiu 1997 (disk); Malley's method (cosine);
// Pharr, Jakob, Humphreys, PBR 4th ed., appendix A.5.
#ifndef KILOBAND_SHARED_WARP_H
#define KILOBAND_SHARED_WARP_H

#include "shared/filter_sample.h"
#include "shared/fresnel.h"
#include "shared/lang.h"
#include "shared/microfacet.h"
#include "shared/planted_faults.h"

/* A point of the unit disk, uniform (density 1/pi); squares around the centre become circles. */
KB_FN KbFloat2 kb_disk_concentric(float u, float v) {
  const float a = 2.0f * u - 1.0f;
  const float b = 2.0f * v - 1.0f;
  KbFloat2 p;
  p.x = 0.0f;
  p.y = 0.0f;
  if (a == 0.0f && b == 0.0f) return p;
  /* The radius is the larger coordinate; the angle runs over an eighth of a turn with their ratio. */
  const int wide = kb_fabs(a) > kb_fabs(b);
  const float radius = wide ? a : b;
  const float angle = wide ? 0.25f * KB_PI * (b / a) : 0.5f * KB_PI - 0.25f * KB_PI * (a / b);
  p.x = radius * kb_cos(angle);
  p.y = radius * kb_sin(angle);
  return p;
}

/* A direction of the upper hemisphere with density cos(theta) / pi. */
KB_FN KbFloat3 kb_hemisphere_cosine(float u, float v) {
  const KbFloat2 p = kb_disk_concentric(u, v);
  KbFloat3 w;
  w.x = p.x;
  w.y = p.y;
  w.z = kb_sqrt(kb_fmax(0.0f, 1.0f - p.x * p.x - p.y * p.y));
  return w;
}

KB_FN float kb_hemisphere_cosine_pdf(float cos_theta) {
  return kb_fmax(0.0f, cos_theta) * KB_INV_PI;
}

/* The direction of azimuth 2 pi v whose height above z is 1 - one_minus_z; no precision is lost
   near the pole. */
KB_FN KbFloat3 kb_direction_from_pole(float one_minus_z, float v) {
  const float sin_theta = kb_sqrt(kb_fmax(0.0f, one_minus_z * (2.0f - one_minus_z)));
  const float phi = 2.0f * KB_PI * v;
  KbFloat3 w;
  w.x = sin_theta * kb_cos(phi);
  w.y = sin_theta * kb_sin(phi);
  w.z = 1.0f - one_minus_z;
  return w;
}

/* A uniform direction of the sphere. */
KB_FN KbFloat3 kb_sphere_uniform(float u, float v) {
  return kb_direction_from_pole(2.0f * u, v);
}

KB_FN float kb_sphere_uniform_pdf(void) {
  return 0.25f * KB_INV_PI;
}

/* A uniform direction of a cone around z with half angle theta, given as 1 - cos(theta) in (0, 2]: exact also
   for cones as small as the sun's (2e-5) and far smaller ones, where cos(theta) rounds to 1. */
KB_FN KbFloat3 kb_cone_uniform(float u, float v, float one_minus_cos) {
  return kb_direction_from_pole(u * one_minus_cos, v);
}

KB_FN float kb_cone_uniform_pdf(float one_minus_cos) {
  return 0.5f * KB_INV_PI / one_minus_cos;
}

/* 1 - cos of an acute angle from the square of its sine in [0, 1], without cancellation. */
KB_FN float kb_one_minus_cos(float sin_squared) {
  return sin_squared / (1.0f + kb_sqrt(kb_fmax(0.0f, 1.0f - sin_squared)));
}

/* Barycentric coordinates (b1, b2) of a uniform point of a triangle; b0 = 1 - b1 - b2. Density 1 / area. */
KB_FN KbFloat2 kb_triangle_uniform(float u, float v) {
  const float s = KB_PLANTED_SHARED(TRIANGLE_WARP) ? 1.0f - u : kb_sqrt(1.0f - u);
  KbFloat2 b;
  b.x = 1.0f - s;
  b.y = v * s;
  return b;
}

/* Weight of a sample of density a beside a strategy of density b, power heuristic with exponent 2 (Veach
   1997); of the ratio, so that densities of any size neither over- nor underflow. 0 if a is 0; a infinite and
   b finite gives 1. */
KB_FN float kb_power_heuristic(float a, float b) {
  if (!(a > 0.0f)) return 0.0f;
  const float ratio = b / a;
  return 1.0f / (1.0f + ratio * ratio);
}

#endif
