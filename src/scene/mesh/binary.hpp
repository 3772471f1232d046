// Numbers of either byte order from raw bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace kiloband {

/// The number stored at `bytes`, which need not be aligned; sizeof(T) bytes are read.
template <typename T>
T load_number(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

}  // namespace kiloband
