// The hash of checkpoints and fingerprints.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace kiloband {

/// FNV-1a over 64-bit words (the rest of each piece bytewise): fast enough for gigabytes,
/// and every bit counts.
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
    state_ = (state_ ^ word) * 0x100000001b3ull;
    state_ ^= state_ >> 29;  // the multiplication alone never carries high bits down
  }
  uint64_t state_ = 0xcbf29ce484222325ull;
};

}  // namespace kiloband
