// Records of thermal emission: what surfaces emit towards a direction, and the energy compensation of rough materials
// that goes with it.
#ifndef KILOBAND_SHARED_THERMAL_H
#define KILOBAND_SHARED_THERMAL_H

#include "shared/lang.h"

/* ---- energy compensation of rough materials that emit thermally ---------------------------------------------------
   Single scattering loses what scatters twice; as absorption it would be emission. With E(wi) the albedo of the lobe
   (of conductors and plastics: for F = 1), conductors are scaled by 1 + F0 (1 - E) / E, F0 = reflectance at normal
   incidence (Turquin, "Practical multiple scattering compensation for microfacet models", 2019), dielectrics and the
   specular lobe of plastics by 1 / E.

   The table: a header, then E at KB_COMPENSATION_NODES positions x for each node of s, of the relative index, of the
   side (dielectrics: outside, inside), the last being outermost; linear in between. In the local frame
     x = |z| / (|z| + hypot(alpha_u x, alpha_v y)) in [0, 1],
     s = (p y)^2 / ((o x)^2 + (p y)^2) in [0, 1] (0 where both are 0), o and p = alpha_u and alpha_v, whose fourth roots
         for dielectrics, where the true azimuth counts too (Fresnel's reflectance, total reflection). */
#define KB_COMPENSATION_NODES 257
#define KB_COMPENSATION_HEADER 4 /* nodes of s, nodes of the index, first index, its nodes per unit */

/* ---- thermal emission ----------------------------------------------------------------------------------------------
   What one side of a surface emits towards a direction: eps B(lambda, T), eps = 1 - what it reflects and transmits of
   light from there. It is chosen from emission spectra (rows of the spectrum table, textures) by a random number:

     KB_THERMAL_UNIFORM  ref[0], for every direction
     KB_THERMAL_NODES    a row of eps at one of the neighbouring directions of a table: row first_row + i + nodes_cos j,
                         i of the table's cosines (ascending from 0 to 1), j of nodes_s equidistant values of s (above),
                         chosen with the weights of linear interpolation
     KB_THERMAL_SMOOTH   the sum of c_i ref[i] (absent: 0) with c_0 = R, and of plastics c_1 = q (1 - R),
                         c_2 = 1 - c_0 - c_1, of dielectrics c_1 = 1 - R and all times index^2 seen from inside, where
                         equilibrium radiance is higher by that. R is Fresnel's reflectance F, of panes 2 F / (1 + F)
                         with c_1 = 1 - R. ref[i] is chosen in proportion to c_i
     KB_THERMAL_ROUGH    the same with R from a table of KB_COMPENSATION_NODES by nodes_s positions (dielectrics:
                         outside, then inside), s as above, x = kb_reflected_position(); of plastics q (1 - R) is
                         replaced by KB_COAT_NODES values at equidistant cosines, which follow it */
enum KbThermalType {
  KB_THERMAL_UNIFORM = 0,
  KB_THERMAL_NODES = 1,
  KB_THERMAL_SMOOTH = 2,
  KB_THERMAL_ROUGH = 3
};

/* Where a cosine lies in a table of reflected parts, in [0, 1]; eta: index of the far side over that of the near one.
   E is a function of cos / (alpha sin), R of the cosine, whatever the roughness: at alpha = 1e-4 all directions up to
   88.5 degrees share the last cell of a grid that suits E. R bends within some alpha of grazing incidence and, where
   eta < 1, is steepest at the critical angle, at a smooth boundary as a root: 1 - R ~ sqrt(cos - cos_c). So positions
   are roots of distances from there, by which R is smooth; below the critical angle is one half, above it the other. */
KB_FN float kb_reflected_position(float cosine, float eta) {
  if (eta >= 1.0f) return kb_sqrt(cosine);
  const float critical = kb_sqrt(1.0f - eta * eta);
  if (cosine < critical) return 0.5f - 0.5f * kb_sqrt((critical - cosine) / critical);
  return 0.5f + 0.5f * kb_sqrt((cosine - critical) / (1.0f - critical));
}

#define KB_THERMAL_TRANSMITS 1u /* a dielectric with an inside */
#define KB_THERMAL_THIN 2u      /* a pane */

typedef struct {
  kb_u32 type;   /* KbThermalType */
  kb_u32 flags;  /* KB_THERMAL_TRANSMITS, KB_THERMAL_THIN */
  kb_u32 ref[3]; /* emission spectra or bitmaps or checkerboards of them, or KB_NONE */
  kb_u32 table;  /* into the tables of the scene, or KB_NONE */
  kb_u32 nodes_cos, nodes_s;
  kb_u32 first_row;
  float eta;              /* interior over exterior index */
  float q;                /* smooth plastic */
  float alpha_u, alpha_v; /* what s is made of; KB_THERMAL_NODES: roots of the roughnesses */
  kb_u32 field; /* where T depends on the place: a bitmap of kelvins, or KB_FIELD_VERTEX; else KB_NONE */
  kb_u32 field_offset; /* KB_FIELD_VERTEX: T of vertex i is entry field_offset + i (mod 2^32) of the tables */
  kb_u32 reserved;
} KbThermal;
KB_STATIC_ASSERT(sizeof(KbThermal) == 64, thermal_size);
#define KB_FIELD_VERTEX 0xfffffffeu

/* In place of a KbTextureSample of emission, told by KB_SAMPLE_THERMAL in its first word: the value of a row or of a
   bilinear lookup (both emissivities) times Planck's law at temperature_k. */
#define KB_SAMPLE_THERMAL 0x80000000u
#define KB_SAMPLE_ROW 0x40000000u
#define KB_SAMPLE_INDEX_MASK 0x3fffffffu
typedef struct {
  kb_u32 source;    /* KB_SAMPLE_THERMAL | texture, or KB_SAMPLE_THERMAL | KB_SAMPLE_ROW | row */
  kb_u32 xy;        /* as KbTextureSample */
  kb_u32 fractions; /* fx | fy << 16, in units of 1 / 65535 */
  float temperature_k;
} KbThermalSample;
KB_STATIC_ASSERT(sizeof(KbThermalSample) == 16, thermal_sample_size);

#endif
