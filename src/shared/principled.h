/* The numbers of a principled material, in the scene's tables where KbMaterial::table says (material_tables.h).

   The model is that of B. Burley, "Physically Based Shading at Disney" (SIGGRAPH courses 2012) and "Extending the Disney
   BRDF to a BSDF with Integrated Subsurface Scattering" (2015), with the choices of Mitsuba 3's `principled` and
   `principledthin`: exact Fresnel reflectance of dielectrics, GGX with Smith's masking, radiance scaled by 1 / eta^2.

   Spectrally there is one spectrum, the base colour S; everything else is a number. What is reflected is w0 S + w1: a
   tint is S over its luminance. What is refracted has sqrt(S), as light passes two such boundaries; what passes a thin
   sheet has S. */
#ifndef KILOBAND_SHARED_PRINCIPLED_H
#define KILOBAND_SHARED_PRINCIPLED_H

#include "shared/lang.h"

enum KbPrincipledNumber {
  KB_PRINCIPLED_ROUGHNESS = 0,
  KB_PRINCIPLED_ANISOTROPIC = 1,
  KB_PRINCIPLED_METALLIC = 2,
  KB_PRINCIPLED_SPEC_TRANS = 3,
  KB_PRINCIPLED_ETA = 4, /* interior over exterior index */
  KB_PRINCIPLED_SPEC_TINT = 5,
  KB_PRINCIPLED_SHEEN = 6,
  KB_PRINCIPLED_SHEEN_TINT = 7,
  KB_PRINCIPLED_FLATNESS = 8,
  KB_PRINCIPLED_CLEARCOAT = 9,
  KB_PRINCIPLED_CLEARCOAT_GLOSS = 10,
  KB_PRINCIPLED_DIFF_TRANS = 11,
  KB_PRINCIPLED_LUMINANCE = 12, /* of the base colour under D65; only where something is tinted */
  KB_PRINCIPLED_MAPPED = 13,    /* those before may be bitmaps: scene array principled_maps */
  KB_PRINCIPLED_BASE = 13,      /* mean of the base colour over the guide bands: for choosing lobes */
  /* Factors of the lobes' probabilities; thick: diffuse, specular, clearcoat; thin: diffuse reflection,
     specular reflection, specular transmission, diffuse transmission. */
  KB_PRINCIPLED_RATES = 14,
  KB_PRINCIPLED_NUMBERS = 18
};

/* Roughness squared is at least this. */
#define KB_PRINCIPLED_LEAST_ALPHA 1e-3f
/* A base colour of less luminance tints nothing. */
#define KB_PRINCIPLED_LEAST_LUMINANCE 1e-4f
/* Each lobe that scatters anything is chosen at least this often. */
#define KB_PRINCIPLED_LEAST_LOBE 0.05f
/* Channels may have more of the base colour than the guide's mean: at least this part is taken for sampling. */
#define KB_PRINCIPLED_LEAST_BASE 0.1f

#endif
