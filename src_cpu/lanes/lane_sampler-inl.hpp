// The random numbers of shared/sampler.h, and the maps of shared/warp.h, for each lane.
//
// Random numbers are those of shared/sampler.h to the last bit; maps agree to rounding.
// For one lane or a vector of them: see one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_LANE_SAMPLER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LANE_SAMPLER_INL
#undef KILOBAND_LANE_SAMPLER_INL
#else
#define KILOBAND_LANE_SAMPLER_INL
#endif

#include "shared/sampler.h"
#include "shared/sobol_table.h"
#include "src_cpu/lanes/lane_math-inl.hpp"
#include "src_cpu/lanes/vector3-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

struct F4 {
  F x, y, z, w;
};

/// 24 bits of each word: [0, 1 - 2^-24].
KB_INLINE F unit_floats(U words) {
  return to_floats(shift_right<8>(words)) * F(0x1p-24f);
}

/// Philox4x32-10 (shared/philox.h): four numbers of the counter (c0, c1, c2, c3).
KB_INLINE F4 philox_floats(uint64_t seed, U c0, U c1, U c2, U c3) {
  U x = c0, y = c1, z = c2, w = c3;
  uint32_t key0 = kb_low32(seed), key1 = kb_high32(seed);
  for (int round = 0; round < 10; ++round) {
    U high0, low0, high1, low1;
    multiply_wide(x, 0xd2511f53u, high0, low0);
    multiply_wide(z, 0xcd9e8d57u, high1, low1);
    x = high1 ^ y ^ U(key0);
    y = low1;
    z = high0 ^ w ^ U(key1);
    w = low0;
    key0 += 0x9e3779b9u;
    key1 += 0xbb67ae85u;
  }
  return {unit_floats(x), unit_floats(y), unit_floats(z), unit_floats(w)};
}

/// kb_owen_reversed().
KB_INLINE U owen_reversed(U x, U seed) {
  x = x ^ (x * U(0x3d20adeau));
  x = x + seed;
  x = x * (shift_right<16>(seed) | U(1u));
  x = x ^ (x * U(0x05526c56u));
  return x ^ (x * U(0x53a22864u));
}

/// kb_mix32().
KB_INLINE U mix_words(U x, U y) {
  x = (x ^ shift_right<16>(x)) * U(0x7feb352du);
  x = x + y;
  x = (x ^ shift_right<15>(x)) * U(0x846ca68bu);
  return x ^ shift_right<16>(x);
}

/// kb_sobol_reversed(). The first dimension is the index itself.
struct SobolPoint {
  U dimension[4];
};
#ifdef KB_ONE_LANE
KB_INLINE SobolPoint sobol_reversed(U reversed_index) {
  const kb_u32x4 point = kb_sobol_reversed(kb_sobol_table, reversed_index.v);
  return {{point[0], point[1], point[2], point[3]}};
}
#else
/// The point is the sum (xor) of what the digits of the index contribute. A digit has as many values as a vector has
/// lanes, so that its table is a register.
struct SobolDigits {
  static constexpr uint32_t kBits = kLanes == 16 ? 4 : kLanes == 8 ? 3 : 2;
  static constexpr uint32_t kDigits = (32 + kBits - 1) / kBits;
  alignas(64) uint32_t value[3][kDigits][kLanes] = {};  // dimensions 1 to 3

  constexpr SobolDigits() {
    for (uint32_t k = 0; k < 3; ++k)
      for (uint32_t digit = 0; digit < kDigits; ++digit)
        for (uint32_t lane = 0; lane < kLanes; ++lane)
          value[k][digit][lane] = sum(k + 1, uint64_t{lane} << (kBits * digit));
  }
  static constexpr uint32_t sum(uint32_t dimension, uint64_t bits) {
    uint32_t total = 0;
    for (uint32_t bit = 0; bit < 32; ++bit)
      if (bits >> bit & 1) total ^= kb_sobol_table[4 * (256 * (bit / 8) + (1u << bit % 8)) + dimension];
    return total;
  }
};
inline constexpr SobolDigits kSobolDigits;

KB_INLINE SobolPoint sobol_reversed(U reversed_index) {
  SobolPoint point{{reversed_bits(reversed_index), U(0u), U(0u), U(0u)}};
  U rest = reversed_index;
  for (uint32_t digit = 0; digit < SobolDigits::kDigits; ++digit) {
    const U lane = rest & U(kLanes - 1);
    for (uint32_t k = 0; k < 3; ++k)
      point.dimension[k + 1] =
          point.dimension[k + 1] ^ chosen_lanes(load(kSobolDigits.value[k][digit]), lane);
    rest = shift_right<SobolDigits::kBits>(rest);
  }
  return point;
}
#endif

/// The four numbers of a block of kb_sampler_block() with the sobol sampler.
KB_INLINE F4 sobol_floats(U reversed_index, U key0, U key1, U block) {
  const U base = key0 + block * U(5u * KB_GOLDEN_32);
  const U shuffled = owen_reversed(reversed_index, mix_words(base, key1));
  const SobolPoint point = sobol_reversed(shuffled);
  const auto number = [&](uint32_t dimension) KB_LAMBDA {
    const U seed = mix_words(base + U((dimension + 1) * KB_GOLDEN_32), key1);
    return unit_floats(reversed_bits(owen_reversed(point.dimension[dimension], seed)));
  };
  return {number(0), number(1), number(2), number(3)};
}

/// A 64-bit word of each lane.
struct LongWord {
  U high, low;
};
KB_INLINE LongWord operator*(LongWord a, uint64_t b) {
  U high, low;
  multiply_wide(a.low, kb_low32(b), high, low);
  return {high + a.low * U(kb_high32(b)) + a.high * U(kb_low32(b)), low};
}
/// a ^ (a >> S), for S in (0, 32).
template <int S>
KB_INLINE LongWord folded(LongWord a) {
  return {a.high ^ shift_right<S>(a.high), a.low ^ (shift_right<S>(a.low) | shift_left<32 - S>(a.high))};
}
/// kb_mix64().
KB_INLINE LongWord mix_long_words(LongWord x) {
  x = folded<30>(x) * 0xbf58476d1ce4e5b9u;
  x = folded<27>(x) * 0x94d049bb133111ebu;
  return folded<31>(x);
}

/// KbSamplerKey of each lane; the seed and the kind of sampler are those of the whole render.
struct SamplerKeys {
  U pixel, sample;   // independent
  U reversed_index;  // sobol
  U key0, key1;      // sobol
};

/// kb_sampler_key().
KB_INLINE SamplerKeys sampler_keys(uint64_t seed, U pixel, uint32_t sample, uint32_t replicate,
                                   uint32_t index_in_replicate) {
  const uint64_t parent = kb_domain_key(seed, KB_DOMAIN_SOBOL);
  const LongWord key = mix_long_words({U(kb_high32(parent) ^ replicate), U(kb_low32(parent)) ^ pixel});
  return {pixel, U(sample), U(kb_reverse_bits(index_in_replicate)), key.low, key.high};
}

/// kb_sampler_block().
KB_INLINE F4 sampler_block(uint32_t sampler, uint64_t seed, const SamplerKeys& key, U block) {
  if (sampler == KB_SAMPLER_INDEPENDENT)
    return philox_floats(seed, key.pixel, key.sample, block, U(KB_STREAM_BLOCKS));
  return sobol_floats(key.reversed_index, key.key0, key.key1, block);
}

// ---- maps of the unit square -------------------------------------------------------------------------

/// kb_disk_concentric(): both triangles of the map at once. The larger coordinate is the radius, the angle from the axis at
/// most pi / 4.
KB_INLINE V2 concentric_disk(F u, F v) {
  const F a = F(2) * u - F(1), b = F(2) * v - F(1);
  const F larger = max(abs(a), abs(b)), smaller = min(abs(a), abs(b));
  const SinCos r = sin_cos_of_eighth(F(KB_PI / 4) * (smaller / max(larger, F(1e-30f))));
  const F along = larger * r.cos, across = larger * r.sin;
  // Exchanged by bits: which is larger is random, and for one lane select() would be a branch. Floats that are not
  // negative are ordered as their words are; the sign of the difference is spread over all bits.
  const U wide = U(0u) - shift_right<31>(as_words(abs(b)) - as_words(abs(a)));
  const U exchanged = (as_words(along) ^ as_words(across)) & wide;
  return {copysign(as_floats(as_words(across) ^ exchanged), a),
          copysign(as_floats(as_words(along) ^ exchanged), b)};
}

/// A direction around +z with density cos / pi; cosines are at least 1e-6.
KB_INLINE V3 cosine_hemisphere(F u, F v) {
  const V2 disk = concentric_disk(u, v);
  const F radius = max(abs(F(2) * u - F(1)), abs(F(2) * v - F(1)));
  return {disk.x, disk.y, sqrt(max(F(1e-12f), F(1) - radius * radius))};
}

/// kb_sphere_uniform().
KB_INLINE V3 uniform_sphere(F u, F v) {
  const F below = F(2) * u;
  const F sine = sqrt(max(F(0), below * (F(2) - below)));
  const SinCos azimuth = sin_cos_of_turns(v);
  return {sine * azimuth.cos, sine * azimuth.sin, F(1) - below};
}

/// kb_triangle_uniform(): barycentric coordinates of the second and third corner.
KB_INLINE V2 uniform_triangle(F u, F v) {
  const F root = sqrt(F(1) - u);
  return {F(1) - root, v * root};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
