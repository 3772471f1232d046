// A kernel with its arguments, and launching it.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "src_gpu/device/memory.hpp"

namespace kiloband::opencl {

/// `count` elements of T in local memory, as a kernel argument.
template <class T>
struct LocalArray {
  uint64_t count;
};

class Kernel {
 public:
  Kernel(DeviceContext& context, cl::Kernel kernel, std::string name);

  /// Sets all arguments in order: DeviceBuffer<T>, LocalArray<T>, or a value (scalars and records of
  /// src/shared). They stay until set again. A buffer must live until the launches that use it are done.
  /// throws std::logic_error  number or size of the arguments differ from the kernel's
  template <class... Args>
  Kernel& set(const Args&... args) {
    check_count(sizeof...(Args));
    uint32_t index = 0;
    (set_argument(index++, args), ...);
    return *this;
  }
  /// Sets arguments from `first` on; the others stay as they are.
  template <class... Args>
  Kernel& set_from(uint32_t first, const Args&... args) {
    (set_argument(first++, args), ...);
    return *this;
  }

  /// throws std::logic_error  the kernel has not `count` parameters
  void check_count(uint64_t count) const;

  /// Enqueues work-items first .. first + items - 1, in groups of `local` (0: the driver chooses), or of
  /// max_work_group_size() where that is less: kernels to which it matters have groups that fit. With a
  /// local size the number of work-items is rounded up to whole groups: the kernel compares its global id
  /// with its number of items. No items: no launch.
  /// throws DeviceLost, DeviceOutOfMemory, DeviceError  naming the kernel
  void launch(uint64_t items, uint64_t local = 0, uint64_t first = 0);
  /// The same, waits for it. The context must have profiling.
  /// returns seconds on the device
  double launch_timed(uint64_t items, uint64_t local = 0);
  /// The same without waiting, for seconds_of() after a finish().
  cl::Event launch_event(uint64_t items, uint64_t local = 0);

  /// Under which scale its launches are recorded (DeviceContext::take_longest).
  void set_scale(LaunchScale scale) { scale_ = scale; }

  uint64_t max_work_group_size() const { return max_work_group_size_; }
  const std::string& name() const { return name_; }

 private:
  template <class T>
  void set_argument(uint32_t index, const DeviceBuffer<T>& buffer) {
    set_raw(index, sizeof(cl_mem), &buffer.cl_buffer()());
  }
  template <class T>
  void set_argument(uint32_t index, const LocalArray<T>& local) {
    set_raw(index, local.count * sizeof(T), nullptr);
  }
  template <class T>
  void set_argument(uint32_t index, const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool> && !std::is_pointer_v<T>,
                  "OpenCL passes scalars and records");
    set_raw(index, sizeof(T), &value);
  }
  void set_raw(uint32_t index, uint64_t bytes, const void* value);
  void enqueue(uint64_t items, uint64_t local, uint64_t first, cl::Event* event);
  CallSite site(Phase phase) const;

  DeviceContext* context_;
  cl::Kernel kernel_;
  std::string name_;
  LaunchScale scale_ = LaunchScale::kOther;
  uint32_t argument_count_ = 0;
  uint64_t max_work_group_size_ = 0;
};

}  // namespace kiloband::opencl
