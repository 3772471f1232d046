// The value types of highway_lanes-inl.hpp for one lane: the oracle of the vector code, and the code of what few
// paths need. A header of lanes (NAME-inl.hpp) that is included after this one is compiled for one lane.
//
// F: a float in each lane; U: a 32-bit word in each lane; M: a truth value in each lane. All operations round as
// IEEE 754 has it, one by one (no fused multiply-add), so that every number of lanes gives the same bits.
#pragma once

#include <smmintrin.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#ifdef KB_LANES
#error "one_lane.hpp and highway_lanes-inl.hpp do not go together"
#endif
#define KB_LANES one_lane
#define KB_ONE_LANE 1
#define KB_BEFORE_LANES static_assert(true, "")
#define KB_AFTER_LANES static_assert(true, "")
#define KB_INLINE inline __attribute__((always_inline))
#define KB_LAMBDA __attribute__((always_inline))

namespace kiloband::cpu::one_lane {

inline constexpr uint32_t kLanes = 1;

struct M {
  bool v;
};
struct U {
  uint32_t v;
  U() = default;
  KB_INLINE U(uint32_t x) : v(x) {}
};
struct F {
  float v;
  F() = default;
  KB_INLINE F(float x) : v(x) {}
};

KB_INLINE M operator&(M a, M b) {
  return {a.v && b.v};
}
KB_INLINE M operator|(M a, M b) {
  return {a.v || b.v};
}
KB_INLINE M operator!(M a) {
  return {!a.v};
}
KB_INLINE bool any(M a) {
  return a.v;
}
KB_INLINE uint32_t count(M a) {
  return a.v ? 1 : 0;
}
/// Bit i is set where lane i is.
KB_INLINE uint32_t bits_of(M a) {
  return a.v ? 1 : 0;
}
/// The first n lanes.
KB_INLINE M first_lanes(uint32_t n) {
  return {n > 0};
}

KB_INLINE F operator+(F a, F b) {
  return a.v + b.v;
}
KB_INLINE F operator-(F a, F b) {
  return a.v - b.v;
}
KB_INLINE F operator*(F a, F b) {
  return a.v * b.v;
}
KB_INLINE F operator/(F a, F b) {
  return a.v / b.v;
}
KB_INLINE F operator-(F a) {
  return -a.v;
}
KB_INLINE M operator<(F a, F b) {
  return {a.v < b.v};
}
KB_INLINE M operator>(F a, F b) {
  return {a.v > b.v};
}
KB_INLINE M operator<=(F a, F b) {
  return {a.v <= b.v};
}
KB_INLINE M operator>=(F a, F b) {
  return {a.v >= b.v};
}
KB_INLINE M operator==(F a, F b) {
  return {a.v == b.v};
}
KB_INLINE M operator!=(F a, F b) {
  return {a.v != b.v};
}
KB_INLINE F select(M m, F yes, F no) {
  return m.v ? yes : no;
}
/// The second of two equal ones, or where one is NaN the second: what x86 does.
KB_INLINE F min(F a, F b) {
  return a.v < b.v ? a.v : b.v;
}
KB_INLINE F max(F a, F b) {
  return a.v > b.v ? a.v : b.v;
}
KB_INLINE F sqrt(F a) {
  return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(a.v)));  // std::sqrt asks for its sign, for errno's sake
}
KB_INLINE F abs(F a) {
  return std::fabs(a.v);
}
KB_INLINE F copysign(F magnitude, F sign) {
  return std::copysign(magnitude.v, sign.v);
}
/// Towards minus infinity; of numbers below 2^31 in magnitude.
KB_INLINE F floor(F a) {
  const __m128 x = _mm_set_ss(a.v);
  return _mm_cvtss_f32(_mm_floor_ss(x, x));  // std::floor is a call
}

KB_INLINE U operator+(U a, U b) {
  return a.v + b.v;
}
KB_INLINE U operator-(U a, U b) {
  return a.v - b.v;
}
KB_INLINE U operator*(U a, U b) {
  return a.v * b.v;
}
KB_INLINE U operator&(U a, U b) {
  return a.v & b.v;
}
KB_INLINE U operator|(U a, U b) {
  return a.v | b.v;
}
KB_INLINE U operator^(U a, U b) {
  return a.v ^ b.v;
}
KB_INLINE M operator==(U a, U b) {
  return {a.v == b.v};
}
KB_INLINE M operator!=(U a, U b) {
  return {a.v != b.v};
}
KB_INLINE U select(M m, U yes, U no) {
  return m.v ? yes : no;
}
template <int S>
KB_INLINE U shift_right(U a) {
  return a.v >> S;
}
template <int S>
KB_INLINE U shift_left(U a) {
  return a.v << S;
}
KB_INLINE U shift_right(U a, uint32_t bits) {
  return a.v >> bits;
}
/// Where any of these bits is set.
KB_INLINE M has_bits(U a, uint32_t bits) {
  return {(a.v & bits) != 0};
}
/// The product's upper and lower words.
KB_INLINE void multiply_wide(U a, uint32_t b, U& high, U& low) {
  const uint64_t product = uint64_t{a.v} * b;
  high = static_cast<uint32_t>(product >> 32);
  low = static_cast<uint32_t>(product);
}
KB_INLINE U reversed_bits(U a) {
  uint32_t x = a.v;
  x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
  x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
  x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
  return __builtin_bswap32(x);
}

/// A double in each lane.
struct D {
  double v;
};
/// The same number in each lane.
KB_INLINE D to_doubles(double a) {
  return {a};
}
KB_INLINE D to_doubles(F a) {
  return {a.v};
}
/// Rounded to the nearest.
KB_INLINE F to_floats(D a) {
  return static_cast<float>(a.v);
}
KB_INLINE D operator+(D a, D b) {
  return {a.v + b.v};
}
KB_INLINE D operator-(D a, D b) {
  return {a.v - b.v};
}
KB_INLINE D operator*(D a, D b) {
  return {a.v * b.v};
}
KB_INLINE D operator/(D a, D b) {
  return {a.v / b.v};
}
KB_INLINE D sqrt(D a) {
  return {std::sqrt(a.v)};
}
KB_INLINE D floor(D a) {
  const __m128d x = _mm_set_sd(a.v);
  return {_mm_cvtsd_f64(_mm_floor_sd(x, x))};
}
/// As of floats.
KB_INLINE D min(D a, D b) {
  return {a.v < b.v ? a.v : b.v};
}
KB_INLINE D max(D a, D b) {
  return {a.v > b.v ? a.v : b.v};
}
/// a where |a| < limit, else 0.
KB_INLINE D zero_beyond(D a, double limit) {
  return {std::fabs(a.v) < limit ? a.v : 0};
}

KB_INLINE F as_floats(U a) {
  float x;
  std::memcpy(&x, &a.v, sizeof x);
  return x;
}
KB_INLINE U as_words(F a) {
  uint32_t x;
  std::memcpy(&x, &a.v, sizeof x);
  return x;
}
/// Of whole numbers below 2^31.
KB_INLINE F to_floats(U a) {
  return static_cast<float>(static_cast<int32_t>(a.v));
}
/// Towards zero, as a signed number in two's complement. What is not below 2^31 in magnitude, NaN too, is the largest or least by its
/// sign, as in vectors.
KB_INLINE U to_words(F a) {
  constexpr float kBeyond = 2147483648.0f;
  if (!(a.v > -kBeyond && a.v < kBeyond)) return std::signbit(a.v) ? 0x80000000u : 0x7fffffffu;
  return static_cast<uint32_t>(static_cast<int32_t>(a.v));
}

KB_INLINE F load(const float* p) {
  return *p;
}
KB_INLINE U load(const uint32_t* p) {
  return *p;
}
KB_INLINE void store(F a, float* p) {
  *p = a.v;
}
KB_INLINE void store(U a, uint32_t* p) {
  *p = a.v;
}
KB_INLINE F gather(const float* p, U index) {
  return p[index.v];
}
KB_INLINE U gather(const uint32_t* p, U index) {
  return p[index.v];
}
/// words[k]: word k from the address of each lane. Members of a record are read faster so than one by one: on Zen 4 a
/// gather of 16 lanes takes about as long as 16 loads.
KB_INLINE void load_fours(const uint32_t* const (&from)[kLanes], U (&words)[4]) {
  std::memcpy(words, from[0], sizeof words);
}
/// The lanes of m, one after another; writes kLanes elements.
KB_INLINE void store_chosen(F a, M m, float* p) {
  if (m.v) *p = a.v;
}
KB_INLINE void store_chosen(U a, M m, uint32_t* p) {
  if (m.v) *p = a.v;
}
/// Ends a function over lanes which others call.
KB_INLINE void end_lanes() {}
/// 0, 1, 2, ...
KB_INLINE U lane_numbers() {
  return 0u;
}

}  // namespace kiloband::cpu::one_lane
