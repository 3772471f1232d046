/* Tables of scalars that materials have beside their record, in the scene's array of tables. One after another, where
   KbMaterial::table says:

     rough plastic      KB_COAT_NODES transmittances of its coating from outside, at equidistant cosines from 0 to 1
     conductor, rough   KB_CONDUCTOR_CELLS + 1 upper bounds of Fresnel's reflectance over all channels, at equidistant
     or not, but no     cosines from 0 to 1. F falls from normal incidence to a minimum and rises to 1 at grazing
     perfect mirror     incidence, so that the nodes bound what is between them
     principled         KB_PRINCIPLED_NUMBERS numbers (principled.h)
     compensated        then the table of energy compensation (thermal.h) */
#ifndef KILOBAND_SHARED_MATERIAL_TABLES_H
#define KILOBAND_SHARED_MATERIAL_TABLES_H

#include "shared/records.h"

#define KB_COAT_NODES 64
#define KB_CONDUCTOR_CELLS 64

/* Transmittance of a rough coating, linear between the nodes; clamps the cosine to [0, 1]. */
KB_FN float kb_coat_transmittance(KB_GLOBAL const float* table, float cosine) {
  const float x = kb_fmin(kb_fmax(cosine, 0.0f), 1.0f) * (KB_COAT_NODES - 1);
  const int node = (int)x < KB_COAT_NODES - 2 ? (int)x : KB_COAT_NODES - 2;
  return table[node] + (x - (float)node) * (table[node + 1] - table[node]);
}

/* Upper bound of a conductor's reflectance; clamps the cosine to [0, 1]. table 0: 1 */
KB_FN float kb_conductor_bound(KB_GLOBAL const float* table, float cosine) {
  if (!table) return 1.0f;
  const float x = kb_fmin(kb_fmax(cosine, 0.0f), 1.0f) * KB_CONDUCTOR_CELLS;
  const int cell = (int)x < KB_CONDUCTOR_CELLS - 1 ? (int)x : KB_CONDUCTOR_CELLS - 1;
  return kb_fmax(table[cell], table[cell + 1]);
}

/* Floats in front of the compensation table. */
KB_FN kb_u32 kb_floats_before_compensation(kb_u32 type, kb_u32 flags) {
  if (type == KB_MATERIAL_ROUGH_PLASTIC) return KB_COAT_NODES;
  const bool metal = type == KB_MATERIAL_CONDUCTOR || type == KB_MATERIAL_ROUGH_CONDUCTOR;
  return metal && !(flags & KB_MATERIAL_PERFECT_MIRROR) ? KB_CONDUCTOR_CELLS + 1 : 0;
}

#endif
