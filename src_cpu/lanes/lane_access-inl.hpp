// Arrays of records read by lanes, and lanes one at a time.
//
// For one lane or a vector of them: see one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_LANE_ACCESS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LANE_ACCESS_INL
#undef KILOBAND_LANE_ACCESS_INL
#else
#define KILOBAND_LANE_ACCESS_INL
#endif

#include <bit>
#include <cstddef>

#include "shared/lang.h"
#include "src_cpu/lanes/vector3-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

KB_INLINE M no_lanes() {
  return first_lanes(0);
}
KB_INLINE M select(M m, M yes, M no) {
  return (m & yes) | (no & !m);
}

/// The 32-bit member at `offset` bytes of records[index], as a float or a word. index * sizeof(Record) is below 2^33.
template <class Record>
KB_INLINE F gather_float(const Record* records, std::size_t offset, U index) {
  static_assert(sizeof(Record) % 4 == 0);
  return gather(reinterpret_cast<const float*>(records) + offset / 4, index * U(sizeof(Record) / 4));
}
template <class Record>
KB_INLINE U gather_word(const Record* records, std::size_t offset, U index) {
  static_assert(sizeof(Record) % 4 == 0);
  return gather(reinterpret_cast<const uint32_t*>(records) + offset / 4, index * U(sizeof(Record) / 4));
}
#define KB_GATHER_FLOAT(records, Record, member, index) \
  gather_float<Record>(records, offsetof(Record, member), index)
#define KB_GATHER_WORD(records, Record, member, index) \
  gather_word<Record>(records, offsetof(Record, member), index)

KB_INLINE V3 gather_vector(const KbFloat3* vectors, U index) {
  const float* first = &vectors->x;
  const U at = index * U(3u);
  return {gather(first, at), gather(first + 1, at), gather(first + 2, at)};
}
KB_INLINE V2 gather_pair(const KbFloat2* pairs, U index) {
  const float* first = &pairs->x;
  const U at = index * U(2u);
  return {gather(first, at), gather(first + 1, at)};
}

/// Calls f(lane) for every lane of m, in order.
template <class Function>
KB_INLINE void each_lane(M m, const Function& f) {
  for (uint32_t bits = bits_of(m); bits != 0; bits &= bits - 1)
    f(static_cast<uint32_t>(std::countr_zero(bits)));
}

/// Lanes in memory, where one can be read or replaced.
struct FloatArray {
  alignas(64) float at[kLanes];
  FloatArray() = default;
  KB_INLINE FloatArray(F x) { store(x, at); }
  KB_INLINE operator F() const { return load(at); }
  KB_INLINE float& operator[](uint32_t lane) { return at[lane]; }
  KB_INLINE float operator[](uint32_t lane) const { return at[lane]; }
};
struct WordArray {
  alignas(64) uint32_t at[kLanes];
  WordArray() = default;
  KB_INLINE WordArray(U x) { store(x, at); }
  KB_INLINE operator U() const { return load(at); }
  KB_INLINE uint32_t& operator[](uint32_t lane) { return at[lane]; }
  KB_INLINE uint32_t operator[](uint32_t lane) const { return at[lane]; }
};
struct V3Array {
  FloatArray x, y, z;
  V3Array() = default;
  KB_INLINE V3Array(V3 v) : x(v.x), y(v.y), z(v.z) {}
  KB_INLINE operator V3() const { return {x, y, z}; }
};

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
