/* Numbers of the estimator that both backends must agree on: with others their images would differ by more than
   rounding. */
#ifndef KILOBAND_SHARED_ESTIMATOR_H
#define KILOBAND_SHARED_ESTIMATOR_H

/* Roughness below this is this. */
#define KB_MIN_ALPHA 1e-4f
/* Fraction of a plastic's choice of a lobe that is uniform: each has at least half of it. */
#define KB_UNIFORM_LOBES 0.1f
/* Light that a BSDF scales by less is none. Far tails of normal distributions would otherwise be light or not by whether
   a device flushes denormals. [1/sr] */
#define KB_LEAST_BSDF_VALUE 1e-30f
/* Tables are finite and of order 1 (emission in film units), so a path's value is finite if its weights stay below. */
#define KB_LARGEST_WEIGHT 1e34f
/* A path with more vertices, or null boundaries passed, counts as invalid and is reported. */
#define KB_MAX_VERTICES 100000u
/* Spectral MIS: channels whose densities stand for all (C), and the part of directions that belongs to none (delta). */
#define KB_MAX_HEROES 8u
#define KB_NO_HERO (1.0f / 32.0f)
/* A light that shines on both sides, or by tilted vertex normals, lies edge-on to whatever is in its plane, itself too;
   only rounding would say which side is seen. Below this cosine it is not sampled: BSDF samples find it. */
#define KB_EDGE_ON 1e-6f
/* Beyond this many texels (or for NaN) a texture coordinate has no meaningful fraction; texel 0 is taken. */
#define KB_LARGEST_COORDINATE 1e12f

#endif
