// Fresnel reflectances of unpolarised light, smooth interfaces. Written so that nothing cancels: equal
// indices, grazing angles, the critical angle and good metals (emissivity = 1 - reflectance) are exact to a
// few ulp of the RESULT.
// Source of the physics: Born, Wolf, Principles of Optics, 7th ed., 1.5.2 and 14.2.
#ifndef KILOBAND_SHARED_FRESNEL_H
#define KILOBAND_SHARED_FRESNEL_H

#include "shared/lang.h"

typedef struct {
  float reflectance; /* F in [0, 1] */
  float cos_t;       /* cosine of the refracted direction with the normal, sign opposite to cos_i;
                        0: total reflection */
  float eta_it;      /* index of the transmitted over that of the incident side */
  float eta_ti;      /* 1 / eta_it */
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
  f.eta_ti = cos_i >= 0.0f ? 1.0f / eta : eta;
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

/* 1 - F and F of a conductor. */
typedef struct {
  float reflectance;
  float absorptance;
} KbFresnelConductor;

/* cos_i in [0, 1]; the index is n - i k relative to the outside, n >= 0, k >= 0. Exact, for light from a
   dielectric.

   With s^2 = 1 - c^2, t = n^2 - 1 - k^2 + c^2, q = |(n - ik)^2 - s^2| = sqrt(t^2 + 4 n^2 k^2), and a the real
   part of the root of (n - ik)^2 - s^2, a^2 = (q + t) / 2:
     R_s = (q + c^2 - 2 a c) / (q + c^2 + 2 a c)
     R_p = R_s Q,  Q = (q c^2 + s^4 - 2 a c s^2) / (q c^2 + s^4 + 2 a c s^2).
   q + t cancels where k >> n (silver: 1 - F would lose four digits); there a = n k / b with the imaginary
   part b^2 = (q - t) / 2. 1 - R_s and 1 - Q are taken as fractions of their own; F is what is left of 1. */
KB_FN KbFresnelConductor kb_fresnel_conductor_both(float cos_i, float n, float k) {
  const float c = kb_fmin(kb_fmax(cos_i, 0.0f), 1.0f);
  const float c2 = c * c;
  const float s2 = (1.0f - c) * (1.0f + c);
  const float t = (n - 1.0f) * (n + 1.0f) - k * k + c2;
  const float nk2 = 2.0f * n * k;
  const float q = kb_sqrt(t * t + nk2 * nk2);
  const float root = kb_sqrt(0.5f * (q + kb_fabs(t)));
  const float a = t >= 0.0f ? root : (root > 0.0f ? 0.5f * nk2 / root : 0.0f);
  const float ac2 = 2.0f * a * c;
  const float sum_s = q + c2 + ac2;
  const float sum_p = q * c2 + s2 * s2 + ac2 * s2;
  const float absorbed_s = sum_s > 0.0f ? kb_fmin(2.0f * ac2 / sum_s, 1.0f) : 0.0f;  /* 1 - R_s */
  const float lost_q = sum_p > 0.0f ? kb_fmin(2.0f * ac2 * s2 / sum_p, 1.0f) : 0.0f; /* 1 - Q */
  const float r_s = 1.0f - absorbed_s;
  KbFresnelConductor f;
  f.absorptance = absorbed_s + 0.5f * r_s * lost_q; /* = ((1 - R_s) + (1 - R_s Q)) / 2 */
  f.reflectance = r_s * (1.0f - 0.5f * lost_q);     /* = (R_s + R_s Q) / 2 */
  return f;
}

KB_FN float kb_fresnel_conductor(float cos_i, float n, float k) {
  return kb_fresnel_conductor_both(cos_i, n, k).reflectance;
}

#endif
