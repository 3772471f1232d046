// Fresnel reflectance of unpolarised light, smooth interfaces. Written so that nothing cancels: equal indices,
// grazing angles and the critical angle are exact to a few ulp of the RESULT.
// Source of the physics: Born, Wolf, Principles of Optics, 7th ed., 1.5.2 and 14.2.
#ifndef KILOBAND_SHARED_FRESNEL_H
#define KILOBAND_SHARED_FRESNEL_H

#include "shared/lang.h"

typedef struct {
  float reflectance; /* F in [0, 1] */
  float cos_t;       /* cosine of the refracted direction with the normal, sign opposite to cos_i;
                        0: total reflection */
  float eta_it;      /* index of the transmitted over that of the incident side */
} KbFresnel;

/* cos_i  cosine between the normal and the direction that points away from the surface, in [-1, 1];
          > 0 is outside
   eta    interior over exterior index, > 0

   With n = eta_it, c = |cos_i| and A = n |cos_t| = sqrt(c^2 + n^2 - 1):
     r_s = (c - A) / (c + A)             = -(n^2 - 1) / (c + A)^2
     r_p = (n^2 c - A) / (n^2 c + A)     = (n^2 - 1) ((n^2 + 1) c^2 - 1) / (n^2 c + A)^2
   where the right-hand sides, had by expanding with the sum, do not subtract nearly equal numbers. */
KB_FN KbFresnel kb_fresnel_dielectric(float cos_i, float eta) {
  KbFresnel f;
  f.eta_it = cos_i >= 0.0f ? eta : 1.0f / eta;
  f.reflectance = 0.0f;
  f.cos_t = -cos_i;
  if (eta == 1.0f) return f;
  const float c = kb_fabs(cos_i);
  const float n = f.eta_it;
  const float n2 = n * n;
  const float n2_minus_1 = (n - 1.0f) * (n + 1.0f);
  const float a2 = c * c + n2_minus_1;
  f.reflectance = 1.0f;
  f.cos_t = 0.0f;
  if (a2 <= 0.0f) return f; /* total internal reflection */
  const float a = kb_sqrt(a2);
  const float sum_s = c + a;
  const float sum_p = n2 * c + a;
  const float r_s = n2_minus_1 / (sum_s * sum_s);
  const float r_p = n2_minus_1 / sum_p * (((n2 + 1.0f) * c * c - 1.0f) / sum_p);
  f.reflectance = kb_fmin(0.5f * (r_s * r_s + r_p * r_p), 1.0f);
  f.cos_t = cos_i >= 0.0f ? -kb_fmin(a / n, 1.0f) : kb_fmin(a / n, 1.0f);
  return f;
}

#endif
