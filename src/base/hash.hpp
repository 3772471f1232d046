// Hashes against mistakes and damage, not against intent.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kiloband {

/// FNV-1a: where it begins and what it multiplies by, for 64 and 128 bits. Source: Fowler, Noll, Vo, Eastlake,
/// The FNV Non-Cryptographic Hash Algorithm (RFC 9923).
template <class Word>
inline constexpr Word kFnvBasis = 0xcbf29ce484222325u;
template <class Word>
inline constexpr Word kFnvPrime = 0x100000001b3u;
using Uint128 = unsigned __int128;
template <>
inline constexpr Uint128 kFnvBasis<Uint128> = (Uint128{0x6c62272e07bb0142u} << 64) + 0x62b821756295c58du;
template <>
inline constexpr Uint128 kFnvPrime<Uint128> = (Uint128{1} << 88) + 0x13b;

/// Of the bytes, in continuation of `hash`.
template <class Word = uint64_t>
constexpr Word fnv1a(std::string_view bytes, Word hash = kFnvBasis<Word>) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * kFnvPrime<Word>;
  return hash;
}

/// The hash of checkpoints and fingerprints: as FNV-1a, but a multiplication for 64 bits (the rest of each
/// piece bytewise), fast enough for gigabytes; the shift lets every bit count.
class WordHash {
 public:
  void add(std::span<const char> bytes) {
    std::size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
      uint64_t word;
      std::memcpy(&word, &bytes[i], 8);
      mix(word);
    }
    for (; i < bytes.size(); ++i) mix(static_cast<unsigned char>(bytes[i]));
  }
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add({reinterpret_cast<const char*>(&value), sizeof value});
  }
  template <class T>
  void add_all(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add_value(values.size());
    add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  }
  uint64_t value() const { return state_; }

 private:
  void mix(uint64_t word) {
    state_ = (state_ ^ word) * kFnvPrime<uint64_t>;
    state_ ^= state_ >> 29;  // the multiplication alone never carries high bits down
  }
  uint64_t state_ = kFnvBasis<uint64_t>;
};

}  // namespace kiloband
