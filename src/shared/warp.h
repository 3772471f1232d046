// Maps from uniform random numbers to directions and positions.
//
// u, v are uniform in [0, 1). Directions are unit vectors of a local frame, z up.
// Sources: Shirley, Chiu 1997 (disk); Pharr, Jakob, Humphreys, PBR 4th ed., appendix A.5.
#ifndef KILOBAND_SHARED_WARP_H
#define KILOBAND_SHARED_WARP_H

#include "shared/lang.h"

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

/* A uniform direction of the sphere (density 1 / (4 pi)), of azimuth 2 pi v. */
KB_FN KbFloat3 kb_sphere_uniform(float u, float v) {
  const float one_minus_z = 2.0f * u;
  const float sin_theta = kb_sqrt(kb_fmax(0.0f, one_minus_z * (2.0f - one_minus_z)));
  const float phi = 2.0f * KB_PI * v;
  KbFloat3 w;
  w.x = sin_theta * kb_cos(phi);
  w.y = sin_theta * kb_sin(phi);
  w.z = 1.0f - one_minus_z;
  return w;
}

/* Density of uniform directions of a cone [1/sr], half angle theta, given as 1 - cos(theta) in (0, 2]: exact also for
   cones as small as the sun's (2e-5) and far smaller ones, where cos(theta) rounds to 1. */
KB_FN float kb_cone_uniform_pdf(float one_minus_cos) {
  return 0.5f * KB_INV_PI / one_minus_cos;
}

/* Barycentric coordinates (b1, b2) of a uniform point of a triangle; b0 = 1 - b1 - b2. Density 1 / area. */
KB_FN KbFloat2 kb_triangle_uniform(float u, float v) {
  const float s = kb_sqrt(1.0f - u);
  KbFloat2 b;
  b.x = 1.0f - s;
  b.y = v * s;
  return b;
}

#endif
