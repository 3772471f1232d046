/* The saved vertices of a path: what deferred evaluation reads. Part of records.h. */
#ifndef KILOBAND_SHARED_PATH_VERTEX_H
#define KILOBAND_SHARED_PATH_VERTEX_H

#include "shared/lang.h"

/* ---- path vertices ----------------------------------------------------------------------------------------------
   What deferred evaluation needs of a vertex. With tau_0 = 1, for every channel k at wavelength lambda_k:

     L   += tau * emit_weight * E[emit_row]                               if KB_VERTEX_EMIT
     L   += tau * B(nee0, nee1) * I[nee_row]                              if KB_VERTEX_NEE
     tau *= B(scatter0, scatter1)                                         if KB_VERTEX_SCATTER

   emit_weight is the MIS weight; nee0/1 hold f cos(theta) * MIS weight / pdf of the light sample without the spectral
   parts; scatter0/1 hold f cos(theta) / (pdf * roulette) of the sampled direction. B depends on the kind:

     KB_KIND_SCALED         B(w0, w1) = w0 * S_a
     KB_KIND_TWO_TERM       B(w0, w1) = w0 * S_a + w1 * S_b
     KB_KIND_NONLINEAR      B(w0, w1) = w0 * S_a + w1 * S_b / (1 - S_b + S_b * escape(material))
     KB_KIND_CONDUCTOR      B(w0, w1) = w0 * S_a * F_conductor(cos = w1; eta_row, k_row of the material)
     KB_KIND_DISPERSIVE     B(w0, w1) = w0 * S_a * F_dielectric(cos = w1 signed, eta_row / ext_row or eta_ext of the material);
                            of panes (KB_MATERIAL_THIN), F = F_dielectric(|w1|) from outside: w0 * S_a * 2 F / (1 + F)
                            for w1 > 0, what is reflected; w0 * S_a * (1 - F) / (1 + F) for w1 < 0, what passes
     KB_KIND_ROUGH_TRANSMISSION
                            B(w0, -) = w0 * S_a * T(directions; eta_row / ext_row or eta_ext of the material), see
                            shared/rough_transmission.h: every channel has its own half vector. Such a vertex has a
                            light sample (w0 = nee0) or a scattering event (w0 = scatter0), not both, and no emission:
                            what these would need holds the directions

     KB_KIND_TINTED         B(w0, w1) = w0 * S_a + w1                   for w1 >= 0,
                                        w0 * S_a - w1 * sqrt(S_a)       for w1 < 0

   KB_VERTEX_NEGATIVE, of the first vertex of a path only: tau_0 = -1, where the reconstruction filter is negative.

   KB_VERTEX_DEGRADE: after B is applied only channel kb_surviving_channel(scatter1) goes on, tau of the others becomes 0
   (its kind is SCALED; scatter0 includes 1 / probability of the channel).

   Gas along a ray is a vertex of kind KB_KIND_MEDIUM. It works with a third register q, which is 1 at the path's
   begin; d, in m, is a column and kappa = S[row_a] in 1/m:

     q    = exp(-kappa scatter0)                                             if DEFER alone: gas in front of the next
                                                                             vertex's emission that the path itself
                                                                             does not pass (docs/gases.md)
     L   += tau * q * emit_weight * (1 - exp(-kappa scatter0)) * E[emit_row];  q = 1       if KB_VERTEX_EMIT
     tau *= exp(-kappa scatter0)                                             if KB_VERTEX_SCATTER
     q   *= exp(-kappa nee0);  without DEFER: L += q, q = 1                  if KB_VERTEX_NEE

   The last stands behind a vertex of another kind that has KB_VERTEX_NEE and KB_VERTEX_DEFER: its light goes into q
   instead of L, and a medium vertex follows for every gas along the shadow ray, the last one without DEFER.

   A plume's vertex has n = head >> KB_VERTEX_MATERIAL_SHIFT cells, from near to far: KbPlumeCell records follow, four
   to a entry. Column d_i and temperature T_i at its far end; T_0 = nee0 at the near end of the first; E[emit_row] is
   Planck's law at nee1 kelvin, B(T) the same at T. Within a cell B is linear in the column:

     x = kappa d_i, e = exp(-x);  L += tau q ((1 - e) B(T_(i-1)) + (1 - e (1 + x)) / x (B(T_i) - B(T_(i-1))));  tau *= e */
enum KbVertexKind {
  KB_KIND_SCALED = 0,
  KB_KIND_TWO_TERM = 1,
  KB_KIND_NONLINEAR = 2,
  KB_KIND_CONDUCTOR = 3,
  KB_KIND_DISPERSIVE = 4,
  KB_KIND_MEDIUM = 5,
  KB_KIND_ROUGH_TRANSMISSION = 6,
  KB_KIND_TINTED = 7
};

/* Does B have S_b? */
KB_FN bool kb_has_two_spectra(kb_u32 kind) {
  return kind == KB_KIND_TWO_TERM || kind == KB_KIND_NONLINEAR;
}

/* Is w1 a weight, too? Else it is an argument of the spectral factor. */
KB_FN bool kb_has_two_weights(kb_u32 kind) {
  return kb_has_two_spectra(kind) || kind == KB_KIND_TINTED;
}

#define KB_VERTEX_KIND_MASK 0x7u
#define KB_VERTEX_EMIT 0x8u
#define KB_VERTEX_NEE 0x10u
#define KB_VERTEX_SCATTER 0x20u
#define KB_VERTEX_DEGRADE 0x40u
/* Textured values: row_* is unused and a KbTextureSample follows the vertex, in this order, two to a 32-byte entry. */
#define KB_VERTEX_TEX_A 0x80u
#define KB_VERTEX_TEX_B 0x100u
#define KB_VERTEX_TEX_EMIT 0x200u
#define KB_VERTEX_TEX_NEE 0x400u
#define KB_VERTEX_TEX_MASK 0x780u
#define KB_VERTEX_DEFER 0x800u
#define KB_VERTEX_NEGATIVE 0x1000u
#define KB_VERTEX_MATERIAL_SHIFT 13

typedef struct {
  kb_u32 head; /* kind | flags | material << KB_VERTEX_MATERIAL_SHIFT */
  kb_u16 row_a, row_b;
  kb_u16 emit_row, nee_row;
  float emit_weight;
  float nee0, nee1;
  float scatter0, scatter1;
} KB_ALIGNED(16) KbPathVertex;
KB_STATIC_ASSERT(sizeof(KbPathVertex) == 32, path_vertex_size);

/* A bilinear lookup: texels (x0, y0) (x1, y0) (x0, y1) (x1, y1) after wrapping, weights from fx and fy in [0,1].
   The neighbours x1 = x0 + 1 and y1 = y0 + 1 are wrapped again by the texture's rule. */
typedef struct {
  kb_u32 texture;
  kb_u32 xy; /* x0 | y0 << 16 */
  float fx, fy;
} KB_ALIGNED(16) KbTextureSample;
KB_STATIC_ASSERT(sizeof(KbTextureSample) == 16, texture_sample_size);

typedef struct {
  float column;        /* m */
  float temperature_k; /* at the far end */
} KB_ALIGNED(8) KbPlumeCell;
KB_STATIC_ASSERT(sizeof(KbPlumeCell) == 8, plume_cell_size);

/* 32-byte entries that follow the vertex. */
KB_FN kb_u32 kb_vertex_extensions(kb_u32 head) {
  if ((head & KB_VERTEX_KIND_MASK) == KB_KIND_MEDIUM) return ((head >> KB_VERTEX_MATERIAL_SHIFT) + 3u) / 4u;
  return (kb_popcount(head & KB_VERTEX_TEX_MASK) + 1u) / 2u;
}

/* The channel that goes on behind KB_VERTEX_DEGRADE, as scatter1 holds it: its number as a float, exact below 2^24. Its bits would be a
   subnormal float: compilers may divide by 1 where a weight is not divided (LLVM makes one operation of "w / q or w"), and processors that
   flush subnormals to 0 then make every channel the first one. */
KB_FN float kb_channel_weight(kb_u32 channel) {
  return (float)channel;
}
KB_FN kb_u32 kb_surviving_channel(float scatter1) {
  return (kb_u32)scatter1;
}

#endif
