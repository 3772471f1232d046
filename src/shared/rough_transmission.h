// A vertex of kind KB_KIND_ROUGH_TRANSMISSION: the pair of directions that it holds,
// and the spectral factor T.
//
// A pair (wi, wo) on two sides of a rough boundary is refracted at a facet whose normal m depends on the
// index e (far over near side): m ~ wi + e wo. With F Fresnel's reflectance and D the density of normals
// (Walter et al. 2007),
//   T(e) = (1 - F(wi.m)) D(m) (wi.m) |wo.m| / |wi + e wo|^2,   0 where the facet is seen from a wrong side,
// so that f |cos theta_o| = T(e) G1(wi) G1(wo) / cos_i, radiance scaling 1 / e^2 included; masking G1 does
// not depend on m and is part of the vertex' weight.
#ifndef KILOBAND_SHARED_ROUGH_TRANSMISSION_H
#define KILOBAND_SHARED_ROUGH_TRANSMISSION_H

#include "shared/estimator.h"
#include "shared/lang.h"
#include "shared/records.h"

/* Local frame of the side that the path comes from: wi.z > 0, wo.z < 0. Not stored. */
typedef struct {
  float ix, iy, iz;
  float ox, oy, oz;
  kb_u32 inside; /* the path comes from the interior: e is the reciprocal of interior over exterior */
} KbTransmissionPair;

KB_FN float kb_third_component(float x, float y) {
  return kb_sqrt(kb_fmax(0.0f, 1.0f - x * x - y * y));
}

/* The directions that the vertex holds. */
KB_FN KbTransmissionPair kb_transmission_pair(KbPathVertex v) {
  KbTransmissionPair p;
  const kb_u32 nee = v.head & KB_VERTEX_NEE;
  p.ix = v.emit_weight;
  p.iy = nee ? v.scatter0 : v.nee0;
  p.ox = v.nee1;
  p.oy = v.scatter1;
  p.iz = kb_third_component(p.ix, p.iy);
  p.oz = -kb_third_component(p.ox, p.oy);
  p.inside = v.row_b;
  return p;
}

#endif
