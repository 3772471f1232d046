// The map of random dimensions, for both backends. Every random number of a render is a pure function of
// (seed, pixel, sample, dimension); nothing has a state, so any sample can be recomputed alone.
//
//   block 0       camera: x, y film position; z, w lens
//   block 1 + 2b  light selection at bounce b: x emitter, y triangle or the like, z, w position on it
//   block 2 + 2b  BSDF and roulette at bounce b: x lobe, y, z direction, w roulette
//
// independent: Philox with counter (pixel, sample, block, stream), key = seed; streams are named below.
// sobol: the point index_in_replicate of a 4-D Owen-scrambled Sobol set of its own for each (seed, replicate,
// pixel, block). Replicates are independent of each other;
// the points of one replicate are stratified together.
//
// `sample` counts all samples of a pixel; with R replicates it belongs to replicate sample % R and is the
// point sample / R of it. All floats are multiples of 2^-24 in [0, 1 - 2^-24].
#ifndef KILOBAND_SHARED_SAMPLER_H
#define KILOBAND_SHARED_SAMPLER_H

#include "shared/hash.h"
#include "shared/lang.h"
#include "shared/philox.h"
#include "shared/sobol.h"

#define KB_SAMPLER_INDEPENDENT 0u
#define KB_SAMPLER_SOBOL 1u

/* The fourth word of the Philox counter. */
#define KB_STREAM_BLOCKS 0u
#define KB_STREAM_MU 1u
#define KB_STREAM_DEGRADE 2u
#define KB_STREAM_THERMAL 3u
#define KB_STREAM_HEROES 5u

/* Parents of the keys of scrambled sequences: one per use, so that no two uses share a key. */
#define KB_DOMAIN_SOBOL 0x6b62736f626f6c31ul
#define KB_DOMAIN_PATH_MU 0x6b62706174686d75ul
#define KB_DOMAIN_SHARED_MU 0x6b62736861726564ul

/* Block numbers. */
#define KB_BLOCK_CAMERA 0u
KB_FN kb_u32 kb_block_light(kb_u32 bounce) {
  return 1u + 2u * bounce;
}
KB_FN kb_u32 kb_block_bsdf(kb_u32 bounce) {
  return 2u + 2u * bounce;
}

/* What all blocks of one path have in common. Make it once per path. Not stored. */
typedef struct {
  kb_u64 seed;
  kb_u32 sampler; /* KB_SAMPLER_* */
  kb_u32 pixel, sample;
  kb_u32 reversed_index;         /* sobol: bit-reversed index_in_replicate */
  kb_u32 key0, key1;             /* sobol: of (seed, replicate, pixel) */
  KB_GLOBAL const kb_u32* table; /* kb_sobol_table */
} KbSamplerKey;

/* The root of the keys of one use of one seed. */
KB_FN kb_u64 kb_domain_key(kb_u64 seed, kb_u64 domain) {
  return kb_mix64(kb_mix64(seed ^ domain) + domain);
}

/* What all keys of a seed begin with. */
KB_FN kb_u64 kb_sampler_root(kb_u64 seed) {
  return kb_domain_key(seed, KB_DOMAIN_SOBOL);
}

/* root                kb_sampler_root(seed)
   pixel               y * width + x of the FULL film, whatever is cropped or tiled
   sample              index among all samples of the pixel
   replicate           and index_in_replicate: where the sample was dealt to; not read by the independent
                       sampler
   table               kb_sobol_table */
KB_FN KbSamplerKey kb_sampler_key(kb_u32 sampler, kb_u64 seed, kb_u64 root, kb_u32 pixel, kb_u32 sample,
                                  kb_u32 replicate, kb_u32 index_in_replicate,
                                  KB_GLOBAL const kb_u32* table) {
  const kb_u64 key = kb_hash_pair(root, replicate, pixel);
  KbSamplerKey k;
  k.seed = seed;
  k.sampler = sampler;
  k.pixel = pixel;
  k.sample = sample;
  k.reversed_index = kb_reverse_bits(index_in_replicate);
  k.key0 = kb_low32(key);
  k.key1 = kb_high32(key);
  k.table = table;
  return k;
}

/* The four numbers of a block. By its address: a copy of a key that has just been made would wait for it to reach memory. */
KB_FN KbFloat4 kb_sampler_block(const KbSamplerKey* key, kb_u32 block) {
  if (key->sampler == KB_SAMPLER_INDEPENDENT)
    return kb_philox_floats(key->seed, key->pixel, key->sample, block, KB_STREAM_BLOCKS);
  return kb_unit_float4(kb_sobol_block(key->table, key->reversed_index, key->key0, key->key1, block));
}

/* Wavelength offset of one path (per-path wavelengths). sobol: a scrambled van der Corput point, so that the
   paths of a replicate of a pixel have stratified offsets. */
KB_FN float kb_path_mu(kb_u32 sampler, kb_u64 seed, kb_u32 pixel, kb_u32 sample, kb_u32 replicate,
                       kb_u32 index_in_replicate) {
  if (sampler == KB_SAMPLER_INDEPENDENT) return kb_philox_floats(seed, pixel, sample, 0u, KB_STREAM_MU).x;
  const kb_u64 key = kb_hash_pair(kb_domain_key(seed, KB_DOMAIN_PATH_MU), replicate, pixel);
  return kb_unit_float(kb_van_der_corput(index_in_replicate, kb_low32(key), kb_high32(key)));
}

/* Wavelength offset that all pixels of a 32 x 32 block share (shared wavelengths), with either sampler.
   block_x, block_y    pixel / 32 in the FULL film, whatever tiles and devices there are */
KB_FN float kb_shared_mu(kb_u64 seed, kb_u32 replicate, kb_u32 block_x, kb_u32 block_y,
                         kb_u32 index_in_replicate) {
  const kb_u64 parent = kb_mix64(kb_domain_key(seed, KB_DOMAIN_SHARED_MU) ^ (kb_u64)replicate);
  const kb_u64 key = kb_hash_pair(parent, block_y, block_x);
  return kb_unit_float(kb_van_der_corput(index_in_replicate, kb_low32(key), kb_high32(key)));
}

/* For rough dispersive boundaries (spectral MIS): x places the channels that stand for all,
   the same for the whole path. */
KB_FN float kb_hero_offset(kb_u64 seed, kb_u32 pixel, kb_u32 sample) {
  return kb_philox_floats(seed, pixel, sample, 0xffffffffu, KB_STREAM_HEROES).x;
}

/* At bounce b: x which of them the direction is sampled for, y whether it is sampled for none of them. */
KB_FN KbFloat4 kb_hero_sample(kb_u64 seed, kb_u32 pixel, kb_u32 sample, kb_u32 bounce) {
  return kb_philox_floats(seed, pixel, sample, bounce, KB_STREAM_HEROES);
}

/* Chooses the channel that survives a dispersive refraction at bounce b; independent of everything else. */
KB_FN float kb_degrade_sample(kb_u64 seed, kb_u32 pixel, kb_u32 sample, kb_u32 bounce) {
  return kb_philox_floats(seed, pixel, sample, bounce, KB_STREAM_DEGRADE).x;
}

/* Chooses what a thermally emitting surface is taken to emit (KbThermal) at bounce b: x, y on the surface that was hit,
   z, w on the one that light is sampled from. */
KB_FN KbFloat4 kb_thermal_sample(kb_u64 seed, kb_u32 pixel, kb_u32 sample, kb_u32 bounce) {
  return kb_philox_floats(seed, pixel, sample, bounce, KB_STREAM_THERMAL);
}

#endif
