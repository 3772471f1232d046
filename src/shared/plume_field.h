// Temperature and scale of a plume at a point: a lattice of nodes, or an analytic jet.
#ifndef KILOBAND_SHARED_PLUME_FIELD_H
#define KILOBAND_SHARED_PLUME_FIELD_H

#include "shared/records.h"

/* Temperature and scale at a point. */
typedef struct {
  float temperature_k, scale;
} KbGasPoint;

/* fmax and fmin but where a is NaN; host compilers make calls of those. */
KB_FN float kb_larger(float a, float b) {
  return b > a ? b : a;
}
KB_FN float kb_smaller(float a, float b) {
  return b < a ? b : a;
}

/* exp(x) for x <= 0 to 2.5e-7, 0 from -87 on: what is subnormal, devices treat in their own ways. The same bits on host
   and device, so that both cut a ray into the same cells; without branches, so that compilers can work on several at a
   time. x = n ln 2 + r, |r| <= ln 2 / 2, and the series of exp(r) to the sixth power; -88 has n = -127, whose power of
   two has no bits set. */
KB_FN float kb_plume_exp(float x) {
  const float within = x > -87.0f ? x : -88.0f;
  const kb_i32 whole = (kb_i32)(within * 1.44269504f - 0.5f);
  const float n = (float)whole;
  const float r = (within - n * 0.693359375f) + n * 2.12194440e-4f; /* ln 2 in two parts */
  float sum = 1.0f / 720.0f;
  sum = sum * r + 1.0f / 120.0f;
  sum = sum * r + 1.0f / 24.0f;
  sum = sum * r + 1.0f / 6.0f;
  sum = sum * r + 0.5f;
  sum = (sum * r + 1.0f) * r + 1.0f;
  return sum * kb_as_f32((kb_u32)(whole + 127) << 23);
}

KB_FN float kb_plume_mix(float a, float b, float t) {
  return a + t * (b - a);
}

/* The box of four nodes at (x, y) in the plane z, bilinear. */
KB_FN KbFloat2 kb_grid_plane(KB_GLOBAL const KbMedium* m, KB_GLOBAL const KbFloat2* nodes, kb_u32 x, kb_u32 y,
                             kb_u32 z, float fx, float fy) {
  const kb_u32 row = m->nodes[0];
  KB_GLOBAL const KbFloat2* n = nodes + m->first_node + (z * m->nodes[1] + y) * row + x;
  KbFloat2 r;
  r.x = kb_plume_mix(kb_plume_mix(n[0].x, n[1].x, fx), kb_plume_mix(n[row].x, n[row + 1u].x, fx), fy);
  r.y = kb_plume_mix(kb_plume_mix(n[0].y, n[1].y, fx), kb_plume_mix(n[row].y, n[row + 1u].y, fx), fy);
  return r;
}

/* p: node numbers, clamped to the lattice. */
KB_FN KbGasPoint kb_grid_at(KB_GLOBAL const KbMedium* m, KB_GLOBAL const KbFloat2* nodes, KbFloat3 p) {
  const float x = kb_smaller(kb_larger(0.0f, p.x), (float)(m->nodes[0] - 1u));
  const float y = kb_smaller(kb_larger(0.0f, p.y), (float)(m->nodes[1] - 1u));
  const float z = kb_smaller(kb_larger(0.0f, p.z), (float)(m->nodes[2] - 1u));
  kb_u32 i = (kb_u32)x, j = (kb_u32)y, k = (kb_u32)z;
  if (i > m->nodes[0] - 2u) i = m->nodes[0] - 2u;
  if (j > m->nodes[1] - 2u) j = m->nodes[1] - 2u;
  if (k > m->nodes[2] - 2u) k = m->nodes[2] - 2u;
  const KbFloat2 low = kb_grid_plane(m, nodes, i, j, k, x - (float)i, y - (float)j);
  const KbFloat2 high = kb_grid_plane(m, nodes, i, j, k + 1u, x - (float)i, y - (float)j);
  KbGasPoint gas;
  gas.temperature_k = kb_plume_mix(low.x, high.x, z - (float)k);
  gas.scale = kb_plume_mix(low.y, high.y, z - (float)k);
  return gas;
}

/* A round jet far from its nozzle: width w = radius + spread z; with the excess
   c = radius / w exp(-(r / w)^2) the scale is c and the temperature ambient + c (temperature - ambient). */
KB_FN KbGasPoint kb_jet_at(KB_GLOBAL const KbMedium* m, KbFloat3 p) {
  const float w = m->radius + m->spread * p.z;
  const float excess = m->radius / w * kb_plume_exp(-(p.x * p.x + p.y * p.y) / (w * w));
  KbGasPoint gas;
  gas.temperature_k = m->ambient_k + excess * (m->temperature_k - m->ambient_k);
  gas.scale = excess;
  return gas;
}

/* Planck's law at T <= T_r over that at T_r, with x = hc / (k lambda T_r):
     (e^x - 1) / (e^(x T_r / T) - 1) = p (1 - e^-x) / (1 - p e^-x),  p = exp(-x (T_r / T - 1)).
   ratio: T_r / T; hot: kb_plume_exp(-x) */
KB_FN float kb_planck_below(float x, float hot, float ratio) {
  const float p = kb_plume_exp(-x * (ratio - 1.0f));
  return p * (1.0f - hot) / (1.0f - p * hot);
}

/* Row-major 3x4 matrices. */
KB_FN KbFloat3 kb_affine_point(KB_GLOBAL const float* m, KbFloat3 p) {
  KbFloat3 r;
  r.x = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
  r.y = m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7];
  r.z = m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11];
  return r;
}

KB_FN KbFloat3 kb_affine_vector(KB_GLOBAL const float* m, KbFloat3 v) {
  KbFloat3 r;
  r.x = m[0] * v.x + m[1] * v.y + m[2] * v.z;
  r.y = m[4] * v.x + m[5] * v.y + m[6] * v.z;
  r.z = m[8] * v.x + m[9] * v.y + m[10] * v.z;
  return r;
}

#endif
