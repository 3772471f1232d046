// Memory of the host that the device reaches by itself: transfers need no copy by the driver, and go on while the host works.
#pragma once

#include <cstdint>
#include <span>

#include "src_gpu/device/context.hpp"

namespace kiloband::opencl {

/// `count` floats, mapped as long as the object lives. Not copied.
class PinnedFloats {
 public:
  /// throws DeviceOutOfMemory, DeviceLost, DeviceError
  PinnedFloats(DeviceContext& context, uint64_t count);
  ~PinnedFloats();
  PinnedFloats(const PinnedFloats&) = delete;
  PinnedFloats& operator=(const PinnedFloats&) = delete;

  std::span<float> values() const { return values_; }

 private:
  DeviceContext& context_;
  uint32_t generation_;  // of the context that it belongs to
  cl::Buffer buffer_;
  std::span<float> values_;
};

}  // namespace kiloband::opencl
