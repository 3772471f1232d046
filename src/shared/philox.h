// Philox4x32-10, a counter-based generator: four random u32 are a pure function of a 128-bit counter
// and a 64-bit key.
// Source: Salmon, Moraes, Dror, Shaw, "Parallel Random Numbers: As Easy as 1, 2, 3", SC 2011;
// passes BigCrush.
#ifndef KILOBAND_SHARED_PHILOX_H
#define KILOBAND_SHARED_PHILOX_H

#include "shared/hash.h"
#include "shared/lang.h"

typedef struct {
  kb_u32 x, y, z, w;
} KbPhilox4; /* a counter, and the random words */

typedef struct {
  kb_u32 x, y;
} KbPhiloxKey;

KB_STATIC_ASSERT(sizeof(KbPhilox4) == 16, philox4_size);
KB_STATIC_ASSERT(sizeof(KbPhiloxKey) == 8, philox_key_size);

/* One round: two 32 x 32 -> 64 bit products, whose halves are exchanged and mixed with the rest and key. */
KB_FN KbPhilox4 kb_philox_round(KbPhilox4 c, KbPhiloxKey k) {
  const kb_u64 p0 = (kb_u64)c.x * 0xd2511f53ul;
  const kb_u64 p1 = (kb_u64)c.z * 0xcd9e8d57ul;
  KbPhilox4 r;
  r.x = kb_high32(p1) ^ c.y ^ k.x;
  r.y = kb_low32(p1);
  r.z = kb_high32(p0) ^ c.w ^ k.y;
  r.w = kb_low32(p0);
  return r;
}

/* Ten rounds; the key advances by a Weyl sequence (golden ratio, sqrt(3) - 1) between them. */
KB_FN KbPhilox4 kb_philox4x32(KbPhilox4 counter, KbPhiloxKey key) {
  for (int round = 0; round < 10; ++round) {
    counter = kb_philox_round(counter, key);
    key.x += 0x9e3779b9u;
    key.y += 0xbb67ae85u;
  }
  return counter;
}

/* Four floats in [0, 1 - 2^-24] with 24 bits each, of the counter (c0, c1, c2, c3) and the 64-bit
   seed as key. */
KB_FN KbFloat4 kb_philox_floats(kb_u64 seed, kb_u32 c0, kb_u32 c1, kb_u32 c2, kb_u32 c3) {
  KbPhilox4 counter;
  counter.x = c0;
  counter.y = c1;
  counter.z = c2;
  counter.w = c3;
  KbPhiloxKey key;
  key.x = kb_low32(seed);
  key.y = kb_high32(seed);
  const KbPhilox4 r = kb_philox4x32(counter, key);
  KbFloat4 u;
  u.x = kb_unit_float(r.x);
  u.y = kb_unit_float(r.y);
  u.z = kb_unit_float(r.z);
  u.w = kb_unit_float(r.w);
  return u;
}

#endif
