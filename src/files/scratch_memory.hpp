// Large float arrays that may exceed memory.
#pragma once

#include <cstddef>
#include <span>

namespace kiloband {

/// `count` floats, zero at first. Up to `budget_bytes` they live in memory; a larger array is mapped onto a
/// scratch file in the system's temporary folder (TMPDIR), which the system pages in and out and which
/// vanishes with the object.
class ScratchFloats {
 public:
  /// throws DeviceError  no memory, no space in the temporary folder (names it and the system's message)
  ScratchFloats(std::size_t count, std::size_t budget_bytes);
  ~ScratchFloats();
  ScratchFloats(const ScratchFloats&) = delete;
  ScratchFloats& operator=(const ScratchFloats&) = delete;

  std::span<float> values() { return {data_, count_}; }
  std::span<const float> values() const { return {data_, count_}; }

 private:
  float* data_ = nullptr;
  std::size_t count_;
};

}  // namespace kiloband
