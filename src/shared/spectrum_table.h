// The sigmoid of the spectra that stand for colours.
#ifndef KILOBAND_SHARED_SPECTRUM_TABLE_H
#define KILOBAND_SHARED_SPECTRUM_TABLE_H

#include "shared/lang.h"

/* S(v) = 1/2 + v / (2 sqrt(1 + v^2)), in [0, 1]. Source: Jakob, Hanika, "A Low-Dimensional Function Space for
   Efficient Spectral Upsampling", 2019. |v| is limited to 1e18 so that v^2 stays finite; there S is 0 or 1. */
KB_FN float kb_sigmoid(float v) {
  const float w = kb_fmin(kb_fmax(v, -1e18f), 1e18f);
  return 0.5f + 0.5f * w / kb_sqrt(1.0f + w * w);
}

#endif
