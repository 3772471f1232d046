// The inverse error function, with which normal distributions are sampled.
#ifndef KILOBAND_SHARED_FILTER_SAMPLE_H
#define KILOBAND_SHARED_FILTER_SAMPLE_H

#include "shared/lang.h"

/* The inverse of erf on (-1, 1). Relative error below 3e-7 (measured over all multiples of 2^-24 near the
   ends and one in 37 between). At +-1 it is evaluated one ulp inside, +-3.83.
   Source of the polynomials: M. Giles, "Approximating the erfinv function", GPU Computing Gems, Jade
   edition, 2012. */
KB_FN float kb_erf_inv(float x) {
  x = kb_fmin(kb_fmax(x, -KB_ONE_MINUS_EPSILON), KB_ONE_MINUS_EPSILON);
  float w = -kb_log((1.0f - x) * (1.0f + x));
  float p;
  if (w < 5.0f) {
    w = w - 2.5f;
    p = 2.81022636e-08f;
    p = 3.43273939e-07f + p * w;
    p = -3.5233877e-06f + p * w;
    p = -4.39150654e-06f + p * w;
    p = 0.00021858087f + p * w;
    p = -0.00125372503f + p * w;
    p = -0.00417768164f + p * w;
    p = 0.246640727f + p * w;
    p = 1.50140941f + p * w;
  } else {
    w = kb_sqrt(w) - 3.0f;
    p = -0.000200214257f;
    p = 0.000100950558f + p * w;
    p = 0.00134934322f + p * w;
    p = -0.00367342844f + p * w;
    p = 0.00573950773f + p * w;
    p = -0.0076224613f + p * w;
    p = 0.00943887047f + p * w;
    p = 1.00167406f + p * w;
    p = 2.83297682f + p * w;
  }
  return p * x;
}

#endif
