// Microfacet distributions, anisotropic Beckmann and GGX: densities, Smith masking, sampling of normals.
//
// Directions and normals are unit vectors of the local frame, z = surface normal. alpha_u, alpha_v: roughness
// along x and y, > 0. D is normalised as integral D(m) cos(m) dm = 1 over the upper hemisphere [1/sr].
// Shadowing is Smith's, exact for both (Beckmann with erf, where Mitsuba 3 has a rational approximation
// within 0.35 %), so that the density of visible normals is exactly normalised.
// Sources: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007; Heitz,
// "Understanding the Masking-Shadowing Function", JCGT 2014; Heitz, "Sampling the GGX Distribution of Visible
// Normals", JCGT 2018; Heitz, d'Eon 2014 and Jakob 2014 for the visible slopes of Beckmann.
#ifndef KILOBAND_SHARED_MICROFACET_H
#define KILOBAND_SHARED_MICROFACET_H

#include "shared/filter_sample.h"
#include "shared/lang.h"
#include "shared/records.h"

#define KB_MICROFACET_BECKMANN 0u
#define KB_MICROFACET_GGX 1u
#define KB_INV_SQRT_PI 0.56418958354775628695f

KB_FN KbFloat3 kb_float3(float x, float y, float z) {
  KbFloat3 v;
  v.x = x;
  v.y = y;
  v.z = z;
  return v;
}

KB_FN float kb_dot3(KbFloat3 a, KbFloat3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* v / |v|; v must not be 0. */
KB_FN KbFloat3 kb_normalize3(KbFloat3 v) {
  const float inv = 1.0f / kb_sqrt(kb_dot3(v, v));
  return kb_float3(v.x * inv, v.y * inv, v.z * inv);
}

/* D(m), 0 for m below the surface.
     Beckmann  exp(-(x^2/au^2 + y^2/av^2) / z^2) / (pi au av z^4)
     GGX       1 / (pi au av (x^2/au^2 + y^2/av^2 + z^2)^2) */
KB_FN float kb_microfacet_d(kb_u32 distribution, float alpha_u, float alpha_v, KbFloat3 m) {
  if (m.z <= 0.0f) return 0.0f;
  const float x = m.x / alpha_u;
  const float y = m.y / alpha_v;
  const float z2 = m.z * m.z;
  const float norm = KB_PI * alpha_u * alpha_v;
  if (distribution == KB_MICROFACET_GGX) {
    const float s = x * x + y * y + z2;
    return 1.0f / (norm * s * s);
  }
  const float e = kb_exp(-(x * x + y * y) / z2);
  return e > 0.0f ? e / (norm * z2 * z2) : 0.0f;
}

/* Smith's masking of direction v by facets of normal m: 0 where v sees the wrong side of the facet, else
   1 / (1 + Lambda). With a = |z| / sqrt((au x)^2 + (av y)^2), the cotangent over the projected roughness:
     GGX       Lambda = (sqrt(1 + 1/a^2) - 1) / 2
     Beckmann  Lambda = (erf(a) - 1) / 2 + exp(-a^2) / (2 a sqrt(pi)), below 1e-8 for a > 4 */
KB_FN float kb_microfacet_g1(kb_u32 distribution, float alpha_u, float alpha_v, KbFloat3 v, KbFloat3 m) {
  if (kb_dot3(v, m) * v.z <= 0.0f) return 0.0f;
  const float x = alpha_u * v.x;
  const float y = alpha_v * v.y;
  const float xy2 = x * x + y * y;
  const float z2 = v.z * v.z;
  if (distribution == KB_MICROFACET_GGX) return 2.0f / (1.0f + kb_sqrt(1.0f + xy2 / z2));
  if (z2 >= 16.0f * xy2) return 1.0f;
  const float a = kb_fabs(v.z) / kb_sqrt(xy2);
  const float lambda = 0.5f * (kb_erf(a) - 1.0f) + 0.5f * KB_INV_SQRT_PI * kb_exp(-a * a) / a;
  return 1.0f / (1.0f + kb_fmax(lambda, 0.0f));
}

/* Density of visible normals as seen from v (v.z > 0): G1(v) max(0, v.m) D(m) / v.z [1/sr]. */
KB_FN float kb_microfacet_visible_pdf(kb_u32 distribution, float alpha_u, float alpha_v, KbFloat3 v,
                                      KbFloat3 m) {
  if (v.z <= 0.0f) return 0.0f;
  const float g1 = kb_microfacet_g1(distribution, alpha_u, alpha_v, v, m);
  return g1 * kb_fmax(0.0f, kb_dot3(v, m)) * kb_microfacet_d(distribution, alpha_u, alpha_v, m) / v.z;
}

/* A normal with density D(m) cos(m). Slopes of rough surfaces are a radially symmetric pair, stretched. */
KB_FN KbFloat3 kb_microfacet_sample_all(kb_u32 distribution, float alpha_u, float alpha_v, float u, float v) {
  const float r2 = distribution == KB_MICROFACET_GGX ? u / (1.0f - u) : -kb_log(1.0f - u);
  const float r = kb_sqrt(r2);
  const float phi = 2.0f * KB_PI * v;
  return kb_normalize3(kb_float3(alpha_u * r * kb_cos(phi), alpha_v * r * kb_sin(phi), 1.0f));
}

KB_FN float kb_microfacet_all_pdf(kb_u32 distribution, float alpha_u, float alpha_v, KbFloat3 m) {
  return m.z <= 0.0f ? 0.0f : kb_microfacet_d(distribution, alpha_u, alpha_v, m) * m.z;
}

/* Heitz 2018, written with slopes of alpha = 1 in the plane of incidence, wi = (sin, 0, cos): a point (p, q)
   of the projected hemisphere as seen from wi, whose normal is then turned into the frame. */
KB_FN KbFloat2 kb_ggx_visible_slope(float sin_i, float cos_i, float u, float v) {
  const float r = kb_sqrt(u);
  const float phi = 2.0f * KB_PI * v;
  const float q = r * kb_sin(phi);
  const float s = 0.5f * (1.0f + cos_i);
  const float p = (1.0f - s) * kb_sqrt(kb_fmax(0.0f, 1.0f - q * q)) + s * (r * kb_cos(phi));
  const float h = kb_sqrt(kb_fmax(0.0f, 1.0f - p * p - q * q));
  /* normal = p e + q y + h wi with e = (-cos, 0, sin) and wi = (sin, 0, cos); slope = -(x, y) / z */
  const float inv_z = 1.0f / kb_fmax(p * sin_i + h * cos_i, 1e-8f);
  KbFloat2 slope;
  slope.x = (p * cos_i - h * sin_i) * inv_z;
  slope.y = -q * inv_z;
  return slope;
}

/* Beckmann, alpha = 1: the slope x in the plane of incidence has the distribution
     F(x) = (1 + erf(x) + tan(theta)/sqrt(pi) exp(-x^2)) / (the same at cot(theta)),  x <= cot(theta),
   the other slope is Gaussian. With b = erf(x), F is increasing and concave in b, dF/db ~ 1 - x tan(theta),
   so that Newton's method approaches from below after at most one step past the root, which is cut to half
   the way to -1. It starts from the solution for grazing incidence, F = exp(-x^2), scaled to the interval.
   The number of steps is fixed, so that devices agree; residual |F(x) - u| < 2e-6, u being held in
   [1e-6, 1 - 1e-6]. */
KB_FN float kb_beckmann_visible_slope_x(float sin_i, float cos_i, float u) {
  const float tan_i = sin_i / kb_fmax(cos_i, 1e-6f);
  const float cot_i = kb_fmax(cos_i, 1e-6f) / kb_fmax(sin_i, 1e-12f);
  const float top = kb_erf(cot_i);
  const float total = 1.0f + top + KB_INV_SQRT_PI * tan_i * kb_exp(-cot_i * cot_i);
  const float share = kb_fmin(kb_fmax(u, 1e-6f), 1.0f - 1e-6f);
  float b = top - (top + 1.0f) * kb_erf(kb_sqrt(-kb_log(share)));
  for (int step = 0; step < 3; ++step) {
    const float x = kb_erf_inv(b);
    const float excess = 1.0f + b + KB_INV_SQRT_PI * tan_i * kb_exp(-x * x) - share * total;
    b = kb_fmin(kb_fmax(b - excess / (1.0f - x * tan_i), 0.5f * (b - 1.0f)), top);
  }
  return kb_erf_inv(b);
}

/* A normal with the density kb_microfacet_visible_pdf of wi, wi.z > 0. */
KB_FN KbFloat3 kb_microfacet_sample_visible(kb_u32 distribution, float alpha_u, float alpha_v, KbFloat3 wi,
                                            float u, float v) {
  /* Stretch to alpha = 1, take the plane of incidence as x-z plane, sample slopes, turn back, unstretch. */
  const KbFloat3 w = kb_normalize3(kb_float3(alpha_u * wi.x, alpha_v * wi.y, wi.z));
  const float sin_i = kb_sqrt(w.x * w.x + w.y * w.y);
  const float cos_phi = sin_i > 0.0f ? w.x / sin_i : 1.0f;
  const float sin_phi = sin_i > 0.0f ? w.y / sin_i : 0.0f;
  KbFloat2 slope;
  if (distribution == KB_MICROFACET_GGX) {
    slope = kb_ggx_visible_slope(sin_i, w.z, u, v);
  } else {
    slope.x = kb_beckmann_visible_slope_x(sin_i, w.z, u);
    slope.y = kb_erf_inv(2.0f * v - 1.0f);
  }
  const float sx = alpha_u * (cos_phi * slope.x - sin_phi * slope.y);
  const float sy = alpha_v * (sin_phi * slope.x + cos_phi * slope.y);
  return kb_normalize3(kb_float3(-sx, -sy, 1.0f));
}

#endif
