// Lookup of spectra at one wavelength: regular tables, and the sigmoids that stand for colours.
#ifndef KILOBAND_SHARED_SPECTRUM_TABLE_H
#define KILOBAND_SHARED_SPECTRUM_TABLE_H

#include "shared/lang.h"

/* The CIE range, outside which a sigmoid is held constant. */
#define KB_SIGMOID_MIN_NM 360.0f
#define KB_SIGMOID_MAX_NM 830.0f

/* A regular table: entry i belongs to min_nm + i / inv_step_per_nm. Outside the entries the value is 0, or
   that of the nearest entry if extrapolated. */
typedef struct {
  float min_nm;
  float inv_step_per_nm; /* 1 / step [1/nm] */
  kb_u32 first;          /* index of the first entry in the value array */
  kb_u32 count;          /* entries, at least 1 */
  kb_u32 extrapolate;    /* 0 or 1 */
  kb_u32 reserved;
} KbSpectrumTable;
KB_STATIC_ASSERT(sizeof(KbSpectrumTable) == 24, spectrum_table_size);

/* Where a wavelength lies in a table: value = (1 - fraction) v[index] + fraction v[index + 1]. */
typedef struct {
  kb_u32 index;   /* relative to the table's first entry, at most count - 2 (0 if count is 1) */
  float fraction; /* in [0, 1] */
  float inside;   /* 1, or 0 where the value is 0 */
} KbTablePosition;

/* lambda_nm finite. A wavelength that rounds to just outside the range counts as outside: 3e-7 relative. */
KB_FN KbTablePosition kb_table_position(KbSpectrumTable table, float lambda_nm) {
  const float last = (float)(table.count - 1u);
  const float x = (lambda_nm - table.min_nm) * table.inv_step_per_nm;
  const float clamped = kb_fmin(kb_fmax(x, 0.0f), last);
  KbTablePosition p;
  p.inside = (x == clamped || table.extrapolate != 0u) ? 1.0f : 0.0f;
  p.index = (kb_u32)clamped;
  if (table.count > 1u && p.index > table.count - 2u) p.index = table.count - 2u;
  p.fraction = table.count > 1u ? clamped - (float)p.index : 0.0f;
  return p;
}

/* The spectrum's value, linear between entries. values: the array that all tables lie in. */
KB_FN float kb_table_value(KB_GLOBAL const float* values, KbSpectrumTable table, float lambda_nm) {
  const KbTablePosition p = kb_table_position(table, lambda_nm);
  const float v0 = values[table.first + p.index];
  const float v1 = table.count > 1u ? values[table.first + p.index + 1u] : v0;
  return p.inside * (v0 + p.fraction * (v1 - v0));
}

/* S(v) = 1/2 + v / (2 sqrt(1 + v^2)), in [0, 1]. Source: Jakob, Hanika, "A Low-Dimensional Function Space for
   Efficient Spectral Upsampling", 2019. |v| is limited to 1e18 so that v^2 stays finite; there S is 0 or 1. */
KB_FN float kb_sigmoid(float v) {
  const float w = kb_fmin(kb_fmax(v, -1e18f), 1e18f);
  return 0.5f + 0.5f * w / kb_sqrt(1.0f + w * w);
}

/* The value of a texel (c0, c1, c2, scale), see records.h: scale * S(c0 x^2 + c1 x + c2),
   x = lambda held in the CIE range. */
KB_FN float kb_texel_value(KbFloat4 texel, float lambda_nm) {
  const float x = kb_fmin(kb_fmax(lambda_nm, KB_SIGMOID_MIN_NM), KB_SIGMOID_MAX_NM);
  return texel.w * kb_sigmoid((texel.x * x + texel.y) * x + texel.z);
}

#endif
