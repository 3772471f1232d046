// Integer hashes that turn names (seed, replicate, pixel, block) into keys of random permutations.
//
// They are no random number generator: philox.h is. Each is a bijection of its first argument, so different
// names have different keys wherever they fit into it.
#ifndef KILOBAND_SHARED_HASH_H
#define KILOBAND_SHARED_HASH_H

#include "shared/lang.h"

/* 2^32 over the golden ratio, made odd: its multiples are spread evenly. */
#define KB_GOLDEN_32 0x9e3779b9u

/* A 64-bit bijection with full avalanche: the finaliser of SplitMix64 (Steele, Lea, Flood 2014;
   constants by Stafford). */
KB_FN kb_u64 kb_mix64(kb_u64 x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ul;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebul;
  return x ^ (x >> 31);
}

/* The key of (a, b) below a parent key: for one parent, different pairs have different keys. */
KB_FN kb_u64 kb_hash_pair(kb_u64 parent, kb_u32 a, kb_u32 b) {
  return kb_mix64(parent ^ (((kb_u64)a << 32) | (kb_u64)b));
}

/* The low and the high word of a key. */
KB_FN kb_u32 kb_low32(kb_u64 x) {
  return (kb_u32)(x & 0xfffffffful);
}
KB_FN kb_u32 kb_high32(kb_u64 x) {
  return (kb_u32)(x >> 32);
}

/* A 32-bit bijection of x for every y: the multiply-xorshift chain "lowbias32" (C. Wellons, hash-prospector,
   2018), with a second key word added in the middle. */
KB_FN kb_u32 kb_mix32(kb_u32 x, kb_u32 y) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = x + y;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

/* The same of four x at once. */
KB_FN kb_u32x4 kb_mix32x4(kb_u32x4 x, kb_u32 y) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = x + y;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

/* Reverses the order of the 32 bits. */
KB_REVERSAL_FN kb_u32 kb_reverse_bits(kb_u32 x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

KB_REVERSAL_FN kb_u32x4 kb_reverse_bits4(kb_u32x4 x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/* The upper 24 bits as a float in [0, 1 - 2^-24], a multiple of 2^-24. */
KB_FN float kb_unit_float(kb_u32 x) {
  return (float)(kb_i32)(x >> 8) * 5.9604644775390625e-8f;
}

KB_FN KbFloat4 kb_unit_float4(kb_u32x4 x) {
  KbFloat4 u;
  u.x = kb_unit_float(kb_u32x4_x(x));
  u.y = kb_unit_float(kb_u32x4_y(x));
  u.z = kb_unit_float(kb_u32x4_z(x));
  u.w = kb_unit_float(kb_u32x4_w(x));
  return u;
}

#endif
