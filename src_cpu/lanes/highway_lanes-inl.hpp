// Value types for a vector of lanes (Google Highway), compiled once per instruction set: the operations of
// one_lane.hpp, where they are described, with the same bits in every lane.
//
// No include guard of the usual kind: a file that includes itself once per target (hwy/foreach_target.h)
// includes this one as often. A header of lanes that is included after this one is compiled for the target.
#if defined(KILOBAND_HIGHWAY_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_HIGHWAY_LANES_INL
#undef KILOBAND_HIGHWAY_LANES_INL
#else
#define KILOBAND_HIGHWAY_LANES_INL
#endif

#include <hwy/highway.h>

#include <cstdint>

#ifndef KB_LANES
#define KB_LANES HWY_NAMESPACE
#define KB_BEFORE_LANES HWY_BEFORE_NAMESPACE()
#define KB_AFTER_LANES HWY_AFTER_NAMESPACE()
#define KB_INLINE inline __attribute__((always_inline))
#define KB_LAMBDA __attribute__((always_inline))
#endif

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatLanes = hn::ScalableTag<float>;
using WordLanes = hn::RebindToUnsigned<FloatLanes>;
using SignedLanes = hn::RebindToSigned<FloatLanes>;
inline constexpr FloatLanes kFloatLanes;
inline constexpr WordLanes kWordLanes;
inline constexpr SignedLanes kSignedLanes;
inline constexpr uint32_t kLanes = static_cast<uint32_t>(hn::MaxLanes(FloatLanes()));

struct M {
  hn::Mask<FloatLanes> v;
};
struct U {
  hn::Vec<WordLanes> v;
  U() = default;
  KB_INLINE U(hn::Vec<WordLanes> x) : v(x) {}
  KB_INLINE U(uint32_t x) : v(hn::Set(kWordLanes, x)) {}
};
struct F {
  hn::Vec<FloatLanes> v;
  F() = default;
  KB_INLINE F(hn::Vec<FloatLanes> x) : v(x) {}
  KB_INLINE F(float x) : v(hn::Set(kFloatLanes, x)) {}
};

KB_INLINE M operator&(M a, M b) {
  return {hn::And(a.v, b.v)};
}
KB_INLINE M operator|(M a, M b) {
  return {hn::Or(a.v, b.v)};
}
KB_INLINE M operator!(M a) {
  return {hn::Not(a.v)};
}
KB_INLINE bool any(M a) {
  return !hn::AllFalse(kFloatLanes, a.v);
}
KB_INLINE uint32_t count(M a) {
  return static_cast<uint32_t>(hn::CountTrue(kFloatLanes, a.v));
}
KB_INLINE uint32_t bits_of(M a) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloatLanes, a.v, bytes);
  return static_cast<uint32_t>(bytes[0]) | static_cast<uint32_t>(bytes[1]) << 8;
}
KB_INLINE M first_lanes(uint32_t n) {
  return {hn::FirstN(kFloatLanes, n)};
}

KB_INLINE F operator+(F a, F b) {
  return hn::Add(a.v, b.v);
}
KB_INLINE F operator-(F a, F b) {
  return hn::Sub(a.v, b.v);
}
KB_INLINE F operator*(F a, F b) {
  return hn::Mul(a.v, b.v);
}
KB_INLINE F operator/(F a, F b) {
  return hn::Div(a.v, b.v);
}
KB_INLINE F operator-(F a) {
  return hn::Neg(a.v);
}
KB_INLINE M operator<(F a, F b) {
  return {hn::Lt(a.v, b.v)};
}
KB_INLINE M operator>(F a, F b) {
  return {hn::Gt(a.v, b.v)};
}
KB_INLINE M operator<=(F a, F b) {
  return {hn::Le(a.v, b.v)};
}
KB_INLINE M operator>=(F a, F b) {
  return {hn::Ge(a.v, b.v)};
}
KB_INLINE M operator==(F a, F b) {
  return {hn::Eq(a.v, b.v)};
}
KB_INLINE M operator!=(F a, F b) {
  return {hn::Ne(a.v, b.v)};
}
KB_INLINE F select(M m, F yes, F no) {
  return hn::IfThenElse(m.v, yes.v, no.v);
}
KB_INLINE F min(F a, F b) {
  return hn::Min(a.v, b.v);
}
KB_INLINE F max(F a, F b) {
  return hn::Max(a.v, b.v);
}
KB_INLINE F sqrt(F a) {
  return hn::Sqrt(a.v);
}
KB_INLINE F abs(F a) {
  return hn::Abs(a.v);
}
KB_INLINE F copysign(F magnitude, F sign) {
  return hn::CopySign(magnitude.v, sign.v);
}
KB_INLINE F floor(F a) {
  return hn::Floor(a.v);
}

KB_INLINE U operator+(U a, U b) {
  return hn::Add(a.v, b.v);
}
KB_INLINE U operator-(U a, U b) {
  return hn::Sub(a.v, b.v);
}
KB_INLINE U operator*(U a, U b) {
  return hn::Mul(a.v, b.v);
}
KB_INLINE U operator&(U a, U b) {
  return hn::And(a.v, b.v);
}
KB_INLINE U operator|(U a, U b) {
  return hn::Or(a.v, b.v);
}
KB_INLINE U operator^(U a, U b) {
  return hn::Xor(a.v, b.v);
}
KB_INLINE M operator==(U a, U b) {
  return {hn::RebindMask(kFloatLanes, hn::Eq(a.v, b.v))};
}
KB_INLINE M operator!=(U a, U b) {
  return {hn::RebindMask(kFloatLanes, hn::Ne(a.v, b.v))};
}
KB_INLINE U select(M m, U yes, U no) {
  return hn::IfThenElse(hn::RebindMask(kWordLanes, m.v), yes.v, no.v);
}
template <int S>
KB_INLINE U shift_right(U a) {
  return hn::ShiftRight<S>(a.v);
}
template <int S>
KB_INLINE U shift_left(U a) {
  return hn::ShiftLeft<S>(a.v);
}
/// By the same number of bits, which is known only when the program runs.
KB_INLINE U shift_right(U a, uint32_t bits) {
  return hn::ShiftRightSame(a.v, static_cast<int>(bits));
}
KB_INLINE M has_bits(U a, uint32_t bits) {
  return {hn::RebindMask(kFloatLanes, hn::Ne(hn::And(a.v, hn::Set(kWordLanes, bits)), hn::Zero(kWordLanes)))};
}
KB_INLINE void multiply_wide(U a, uint32_t b, U& high, U& low) {
  const hn::RepartitionToWide<WordLanes> wide;
  const auto factor = hn::Set(kWordLanes, b);
  const auto even = hn::MulEven(a.v, factor);
  const auto odd = hn::MulEven(hn::BitCast(kWordLanes, hn::ShiftRight<32>(hn::BitCast(wide, a.v))), factor);
  low = hn::OddEven(hn::BitCast(kWordLanes, hn::ShiftLeft<32>(odd)), hn::BitCast(kWordLanes, even));
  high = hn::OddEven(hn::BitCast(kWordLanes, odd), hn::BitCast(kWordLanes, hn::ShiftRight<32>(even)));
}
/// Nibbles by table, then the bytes of each word the other way round.
KB_INLINE U reversed_bits(U a) {
  const hn::Repartition<uint8_t, WordLanes> bytes;
  alignas(16) static constexpr uint8_t kLow[16] = {0,  128, 64, 192, 32, 160, 96,  224,
                                                   16, 144, 80, 208, 48, 176, 112, 240};
  alignas(16) static constexpr uint8_t kHigh[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
  alignas(16) static constexpr uint8_t kSwap[16] = {3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12};
  const auto mask = hn::Set(bytes, uint8_t{15});
  const auto low = hn::And(hn::BitCast(bytes, a.v), mask);
  const auto high = hn::And(hn::BitCast(bytes, hn::ShiftRight<4>(a.v)), mask);
  const auto reversed = hn::Or(hn::TableLookupBytes(hn::LoadDup128(bytes, kLow), low),
                               hn::TableLookupBytes(hn::LoadDup128(bytes, kHigh), high));
  return hn::BitCast(kWordLanes, hn::TableLookupBytes(reversed, hn::LoadDup128(bytes, kSwap)));
}

// Twice as wide as floats: two vectors.
using DoubleLanes = hn::Repartition<double, FloatLanes>;
using HalfLanes = hn::Half<FloatLanes>;
inline constexpr DoubleLanes kDoubleLanes;
inline constexpr HalfLanes kHalfLanes;
struct D {
  hn::Vec<DoubleLanes> low, high;
};
KB_INLINE D to_doubles(double a) {
  return {hn::Set(kDoubleLanes, a), hn::Set(kDoubleLanes, a)};
}
KB_INLINE D to_doubles(F a) {
  return {hn::PromoteTo(kDoubleLanes, hn::LowerHalf(kHalfLanes, a.v)),
          hn::PromoteTo(kDoubleLanes, hn::UpperHalf(kHalfLanes, a.v))};
}
KB_INLINE F to_floats(D a) {
  return hn::Combine(kFloatLanes, hn::DemoteTo(kHalfLanes, a.high), hn::DemoteTo(kHalfLanes, a.low));
}
KB_INLINE D operator+(D a, D b) {
  return {hn::Add(a.low, b.low), hn::Add(a.high, b.high)};
}
KB_INLINE D operator-(D a, D b) {
  return {hn::Sub(a.low, b.low), hn::Sub(a.high, b.high)};
}
KB_INLINE D operator*(D a, D b) {
  return {hn::Mul(a.low, b.low), hn::Mul(a.high, b.high)};
}
KB_INLINE D operator/(D a, D b) {
  return {hn::Div(a.low, b.low), hn::Div(a.high, b.high)};
}
KB_INLINE D sqrt(D a) {
  return {hn::Sqrt(a.low), hn::Sqrt(a.high)};
}
KB_INLINE D floor(D a) {
  return {hn::Floor(a.low), hn::Floor(a.high)};
}
KB_INLINE D min(D a, D b) {
  return {hn::Min(a.low, b.low), hn::Min(a.high, b.high)};
}
KB_INLINE D max(D a, D b) {
  return {hn::Max(a.low, b.low), hn::Max(a.high, b.high)};
}
KB_INLINE D zero_beyond(D a, double limit) {
  const auto end = hn::Set(kDoubleLanes, limit);
  return {hn::IfThenElseZero(hn::Lt(hn::Abs(a.low), end), a.low),
          hn::IfThenElseZero(hn::Lt(hn::Abs(a.high), end), a.high)};
}

KB_INLINE F as_floats(U a) {
  return hn::BitCast(kFloatLanes, a.v);
}
KB_INLINE U as_words(F a) {
  return hn::BitCast(kWordLanes, a.v);
}
KB_INLINE F to_floats(U a) {
  return hn::ConvertTo(kFloatLanes, hn::BitCast(kSignedLanes, a.v));
}
KB_INLINE U to_words(F a) {
  return hn::BitCast(kWordLanes, hn::ConvertTo(kSignedLanes, a.v));
}

KB_INLINE F load(const float* p) {
  return hn::LoadU(kFloatLanes, p);
}
KB_INLINE U load(const uint32_t* p) {
  return hn::LoadU(kWordLanes, p);
}
KB_INLINE void store(F a, float* p) {
  hn::StoreU(a.v, kFloatLanes, p);
}
KB_INLINE void store(U a, uint32_t* p) {
  hn::StoreU(a.v, kWordLanes, p);
}
KB_INLINE F gather(const float* p, U index) {
  return hn::GatherIndex(kFloatLanes, p, hn::BitCast(kSignedLanes, index.v));
}
KB_INLINE U gather(const uint32_t* p, U index) {
  return hn::GatherIndex(kWordLanes, p, hn::BitCast(kSignedLanes, index.v));
}

/// Blocks of four words from every fourth address.
template <class Words>
KB_INLINE hn::Vec<Words> load_blocks(Words words, const uint32_t* const* from) {
  if constexpr (hn::MaxLanes(Words()) == 4) {
    return hn::LoadU(words, *from);
  } else {
    const hn::Half<Words> half;
    return hn::Combine(words, load_blocks(half, from + hn::MaxLanes(Words()) / 2), load_blocks(half, from));
  }
}
KB_INLINE void load_fours(const uint32_t* const (&from)[kLanes], U (&words)[4]) {
  const hn::RepartitionToWide<WordLanes> pairs;
  const auto block = [&](uint32_t i) KB_LAMBDA { return load_blocks(kWordLanes, from + i); };
  const auto paired = [&](auto a) KB_LAMBDA { return hn::BitCast(pairs, a); };
  const auto r0 = block(0), r1 = block(1), r2 = block(2), r3 = block(3);
  const auto low01 = paired(hn::InterleaveLower(kWordLanes, r0, r1));
  const auto high01 = paired(hn::InterleaveUpper(kWordLanes, r0, r1));
  const auto low23 = paired(hn::InterleaveLower(kWordLanes, r2, r3));
  const auto high23 = paired(hn::InterleaveUpper(kWordLanes, r2, r3));
  words[0] = hn::BitCast(kWordLanes, hn::InterleaveLower(pairs, low01, low23));
  words[1] = hn::BitCast(kWordLanes, hn::InterleaveUpper(pairs, low01, low23));
  words[2] = hn::BitCast(kWordLanes, hn::InterleaveLower(pairs, high01, high23));
  words[3] = hn::BitCast(kWordLanes, hn::InterleaveUpper(pairs, high01, high23));
}

// Chosen lanes are moved together in the register and stored whole: the form of the instruction that writes to
// memory is slow on Zen 4. Below AVX-512 by a table of our own: with GCC 12 Highway 1.0.3's is copied to the stack
// at every call.
#if HWY_TARGET <= HWY_AVX3
KB_INLINE void store_chosen(F a, M m, float* p) {
  hn::StoreU(hn::Compress(a.v, m.v), kFloatLanes, p);
}
KB_INLINE void store_chosen(U a, M m, uint32_t* p) {
  hn::StoreU(hn::Compress(a.v, hn::RebindMask(kWordLanes, m.v)), kWordLanes, p);
}
#else
/// For every mask, which lanes it has.
struct ChosenLanes {
  alignas(32) uint32_t lane[1u << kLanes][kLanes] = {};
  constexpr ChosenLanes() {
    for (uint32_t mask = 0; mask < 1u << kLanes; ++mask) {
      uint32_t chosen = 0;
      for (uint32_t k = 0; k < kLanes; ++k)
        if (mask >> k & 1) lane[mask][chosen++] = k;
    }
  }
};
inline constexpr ChosenLanes kChosenLanes;
KB_INLINE auto chosen_indices(M m) {
  return hn::IndicesFromVec(kFloatLanes, hn::Load(kWordLanes, kChosenLanes.lane[bits_of(m)]));
}
KB_INLINE void store_chosen(F a, M m, float* p) {
  hn::StoreU(hn::TableLookupLanes(a.v, chosen_indices(m)), kFloatLanes, p);
}
KB_INLINE void store_chosen(U a, M m, uint32_t* p) {
  store_chosen(as_floats(a), m, reinterpret_cast<float*>(p));
}
#endif
/// a[lane] in each lane.
KB_INLINE U chosen_lanes(U a, U lane) {
  return hn::TableLookupLanes(a.v, hn::IndicesFromVec(kWordLanes, lane.v));
}
KB_INLINE U lane_numbers() {
  return hn::Iota(kWordLanes, 0u);
}
/// The last thing that a function over lanes does which others call: clears the upper halves of registers, without which code for SSE
/// that comes next is up to twice as slow. GCC 12 does so itself, but not behind the call of a function that takes vectors.
KB_INLINE void end_lanes() {
#if HWY_TARGET <= HWY_AVX2
  _mm256_zeroupper();
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
