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
#include <glm/vec3.hpp>

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

KB_INLINE V2 gather_pair(const KbFloat2* pairs, U index) {
  const float* first = &pairs->x;
  const U at = index * U(2u);
  return {gather(first, at), gather(first + 1, at)};
}

/// Of arrays of up to 2^32 numbers. A vector's places are signed: it is given the middle of the array, and places that
/// count from there.
#ifdef KB_ONE_LANE
inline constexpr uint32_t kArrayMiddle = 0;
#else
inline constexpr uint32_t kArrayMiddle = 1u << 31;
#endif
KB_INLINE F gather_from_large(const float* p, U index) {
  return gather(p + kArrayMiddle, index - U(kArrayMiddle));
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
/// Calls f(word, lanes) for every word that lanes of m have. Lanes of a vector often share what they look up: it is read
/// once then, and tested by ordinary branches.
template <class Function>
KB_INLINE void each_distinct(M m, U word, const Function& f) {
  const WordArray words(word);
  while (any(m)) {
    const uint32_t one = words[static_cast<uint32_t>(std::countr_zero(bits_of(m)))];
    const M lanes = m & (word == U(one));
    f(one, lanes);
    m = m & !lanes;
  }
}

struct V3Array {
  FloatArray x, y, z;
  V3Array() = default;
  KB_INLINE V3Array(V3 v) : x(v.x), y(v.y), z(v.z) {}
  KB_INLINE operator V3() const { return {x, y, z}; }
  KB_INLINE glm::vec3 operator[](uint32_t lane) const { return {x[lane], y[lane], z[lane]}; }
  KB_INLINE void put(uint32_t lane, glm::vec3 v) { x[lane] = v.x, y[lane] = v.y, z[lane] = v.z; }
};

// ---- records ----------------------------------------------------------------------------------------

/// Where records lie, one for each lane.
struct Addresses {
  const uint32_t* at[kLanes];

  /// bytes: of a record; index * bytes may exceed 32 bits
  KB_INLINE Addresses(const void* records, std::size_t bytes, U index) {
    const WordArray indices(index);
    for (uint32_t i = 0; i < kLanes; ++i)
      at[i] = reinterpret_cast<const uint32_t*>(static_cast<const char*>(records) + indices[i] * bytes);
  }
  template <class Record>
  KB_INLINE Addresses(const Record* records, U index) : Addresses(records, sizeof(Record), index) {}

  /// Four words of each record from byte `offset` on.
  KB_INLINE void load(std::size_t offset, U (&words)[4]) const {
    const uint32_t* from[kLanes];
    for (uint32_t i = 0; i < kLanes; ++i) from[i] = at[i] + offset / 4;
    load_fours(from, words);
  }
};

/// Triples of 32-bit numbers. Behind the last one there is another number: lanes read four.
KB_INLINE void gather_triple(const void* triples, U index, U (&words)[3]) {
#ifdef KB_ONE_LANE
  std::memcpy(words, static_cast<const char*>(triples) + std::size_t{index.v} * sizeof words, sizeof words);
#else
  U four[4];
  Addresses(triples, 12, index).load(0, four);
  for (uint32_t k = 0; k < 3; ++k) words[k] = four[k];
#endif
}
KB_INLINE V3 as_vector(U x, U y, U z) {
  return {as_floats(x), as_floats(y), as_floats(z)};
}
KB_INLINE V3 gather_vector(const KbFloat3* vectors, U index) {
  U words[3];
  gather_triple(vectors, index, words);
  return as_vector(words[0], words[1], words[2]);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
