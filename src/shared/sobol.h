// Four-dimensional Owen-scrambled Sobol point sets, and the Owen-scrambled van der Corput sequence.
//
// Sources: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020: more than four dimensions are had
// by padding with independently shuffled and scrambled copies of the first four ("blocks"). Nested uniform
// scrambling is a hash in which a bit depends only on the bits above it (after Laine and Karras 2011); its
// constants are those of N. Vegdahl, "Building a Better LK Hash", 2021.
//
// Everything is done on bit-reversed numbers, where the hash is plain arithmetic. The table (sobol_table.h)
// maps a reversed index to the reversed Sobol point, so an index is reversed once
// and the four results once, together. It is handed in: devices have it in global memory, since constant memory is read one
// address at a time.
#ifndef KILOBAND_SHARED_SOBOL_H
#define KILOBAND_SHARED_SOBOL_H

#include "shared/hash.h"
#include "shared/lang.h"

/* Nested uniform scrambling of bit-reversed x. A bit of the result depends on that bit and lower ones of x: a
   bijection that maps elementary intervals to elementary intervals. */
KB_FN kb_u32 kb_owen_reversed(kb_u32 x, kb_u32 seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  return x ^ (x * 0x53a22864u);
}

/* Four at once, each with its own seed. */
KB_FN kb_u32x4 kb_owen_reversed4(kb_u32x4 x, kb_u32x4 seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  return x ^ (x * 0x53a22864u);
}

/* The first four Sobol dimensions, bit-reversed, of the point whose bit-reversed index is given. table: kb_sobol_table */
KB_FN kb_u32x4 kb_sobol_reversed(KB_GLOBAL const kb_u32* table, kb_u32 reversed_index) {
  const kb_u32 y = reversed_index;
  return kb_u32x4_load(table, y & 0xffu) ^ kb_u32x4_load(table, 256u + ((y >> 8) & 0xffu)) ^
         kb_u32x4_load(table, 512u + ((y >> 16) & 0xffu)) ^ kb_u32x4_load(table, 768u + (y >> 24));
}

/* Point `index` of block `block`: 4 u32 that are 2^32 times the coordinates.
   reversed_index  kb_reverse_bits(index), the same for all blocks of a path
   key0, key1      two words that name the point set (seed, replicate, pixel) */
KB_FN kb_u32x4 kb_sobol_block(KB_GLOBAL const kb_u32* table, kb_u32 reversed_index, kb_u32 key0, kb_u32 key1,
                              kb_u32 block) {
  /* Five seeds: the shuffle's and the four dimensions'. x of kb_mix32 differs for every (block, seed). */
  const kb_u32 base = key0 + 5u * block * KB_GOLDEN_32;
  const kb_u32x4 step = kb_u32x4_of(KB_GOLDEN_32, 2u * KB_GOLDEN_32, 3u * KB_GOLDEN_32, 4u * KB_GOLDEN_32);
  const kb_u32 shuffled = kb_owen_reversed(reversed_index, kb_mix32(base, key1));
  return kb_reverse_bits4(
      kb_owen_reversed4(kb_sobol_reversed(table, shuffled), kb_mix32x4(step + base, key1)));
}

/* Point `index` of the van der Corput sequence, Owen-scrambled; not shuffled: any 2^m points from a multiple
   of 2^m on have one in each interval of length 2^-m. */
KB_FN kb_u32 kb_van_der_corput(kb_u32 index, kb_u32 key0, kb_u32 key1) {
  /* The sequence is the bit-reversed index, so that its bit-reversed value is the index itself. */
  return kb_reverse_bits(kb_owen_reversed(index, kb_mix32(key0, key1)));
}

#endif
