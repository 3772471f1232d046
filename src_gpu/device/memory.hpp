// Buffers on the device, within a budget.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "src_gpu/device/context.hpp"

namespace kiloband::opencl {

/// 70 % of a GPU's or an accelerator's memory. A CPU device shares the memory of the host, which needs it for
/// the film and the scene: a quarter, at most 2 GiB.
uint64_t default_memory_budget(const DeviceInfo& device);

namespace detail {

/// What is in use; outlives its DeviceMemory as long as a buffer lives.
struct MemoryAccount {
  uint64_t budget = 0;
  uint64_t used = 0, peak = 0;
};

/// An untyped buffer of `bytes` (at least 4, so that kernels always get a valid pointer)
/// and its entry in the account.
class RawBuffer {
 public:
  RawBuffer() = default;
  RawBuffer(DeviceContext& context, std::shared_ptr<MemoryAccount> account, std::string what, uint64_t bytes);
  RawBuffer(RawBuffer&& other) noexcept { swap(other); }
  RawBuffer& operator=(RawBuffer&& other) noexcept {
    RawBuffer(std::move(other)).swap(*this);
    return *this;
  }
  ~RawBuffer() { release(); }

  void release() noexcept;
  void swap(RawBuffer& other) noexcept;
  /// wait: complete on return; else `from` and `to` are used until the queue has been waited for
  void write(uint64_t offset, uint64_t bytes, const void* from, bool wait = true);
  void read(uint64_t offset, uint64_t bytes, void* to, bool wait = true) const;
  /// Enqueued; `to` is complete once wait_for() has returned.
  cl::Event read_event(uint64_t offset, uint64_t bytes, void* to) const;
  void wait_for(const cl::Event& event) const;
  /// pattern_bytes 1, 2, 4, 8 ... 128 and a divisor of bytes.
  void fill(uint64_t offset, uint64_t bytes, const void* pattern, uint64_t pattern_bytes);

  const cl::Buffer& cl_buffer() const { return buffer_; }
  const std::string& what() const { return what_; }

 private:
  void check_range(uint64_t offset, uint64_t bytes) const;
  CallSite site() const;

  DeviceContext* context_ = nullptr;
  std::shared_ptr<MemoryAccount> account_;
  std::string what_;
  uint64_t bytes_ = 0;    // that may be used
  uint64_t charged_ = 0;  // in the account
  cl::Buffer buffer_;
};

}  // namespace detail

/// `count` elements on the device. Moved, not copied; freed when destroyed. Contents start undefined.
/// Uploads and downloads wait for what was enqueued before (the queue is in order) and are complete on return; fills and what is
/// called enqueue_... are only enqueued.
/// throws, all transfers: DeviceLost, DeviceOutOfMemory, DeviceError;
///                        std::logic_error for a range beyond the end
template <class T>
class DeviceBuffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  DeviceBuffer() = default;  // no memory; only assignment, size() and empty() are allowed
  DeviceBuffer(detail::RawBuffer raw, uint64_t count) : raw_(std::move(raw)), count_(count) {}

  uint64_t size() const { return count_; }  // elements
  uint64_t bytes() const { return count_ * sizeof(T); }
  bool empty() const { return count_ == 0; }

  /// Host to device, from element `first` on.
  void upload(std::span<const T> values, uint64_t first = 0) {
    raw_.write(first * sizeof(T), values.size_bytes(), values.data());
  }
  /// The same without waiting: the values stay where and as they are until the queue has been waited for.
  void enqueue_upload(std::span<const T> values, uint64_t first = 0) {
    raw_.write(first * sizeof(T), values.size_bytes(), values.data(), false);
  }
  void enqueue_download(std::span<T> values, uint64_t first = 0) const {
    raw_.read(first * sizeof(T), values.size_bytes(), values.data(), false);
  }
  /// Device to host, from element `first` on.
  void download(std::span<T> values, uint64_t first = 0) const {
    raw_.read(first * sizeof(T), values.size_bytes(), values.data());
  }
  /// The same, to be waited for alone.
  cl::Event download_event(std::span<T> values, uint64_t first = 0) const {
    return raw_.read_event(first * sizeof(T), values.size_bytes(), values.data());
  }
  void wait_for(const cl::Event& event) const { raw_.wait_for(event); }
  std::vector<T> download() const {
    std::vector<T> values(count_);
    download(std::span<T>(values));
    return values;
  }
  /// One element.
  T read(uint64_t index) const {
    T value;
    download(std::span<T>(&value, 1), index);
    return value;
  }

  void fill(const T& value) { fill(value, 0, count_); }
  void fill(const T& value, uint64_t first, uint64_t count) {
    static_assert(std::has_single_bit(sizeof(T)) && sizeof(T) <= 128, "OpenCL's patterns; see clear()");
    raw_.fill(first * sizeof(T), count * sizeof(T), &value, sizeof(T));
  }
  /// All bytes 0.
  void clear() {
    const unsigned char zero = 0;
    raw_.fill(0, bytes(), &zero, 1);
  }

  const cl::Buffer& cl_buffer() const { return raw_.cl_buffer(); }

 private:
  detail::RawBuffer raw_;
  uint64_t count_ = 0;
};

/// Hands out the buffers of one context, within a budget.
class DeviceMemory {
 public:
  /// budget  bytes; nothing: default_memory_budget
  explicit DeviceMemory(DeviceContext& context, std::optional<uint64_t> budget = {});

  /// what  for messages: "film", "paths"
  /// throws DeviceOutOfMemory  beyond the budget or the largest allocation of the device; the device refuses
  ///        DeviceLost, DeviceError
  template <class T>
  DeviceBuffer<T> allocate(const std::string& what, uint64_t count) {
    const uint64_t limit = std::numeric_limits<uint64_t>::max() / sizeof(T);
    const uint64_t bytes = count <= limit ? count * sizeof(T) : std::numeric_limits<uint64_t>::max();
    return DeviceBuffer<T>(detail::RawBuffer(context_, account_, what, bytes), count);
  }
  /// A buffer with these values.
  template <class T>
  DeviceBuffer<T> upload(const std::string& what, const std::vector<T>& values) {
    DeviceBuffer<T> buffer = allocate<T>(what, values.size());
    buffer.upload(std::span<const T>(values));
    return buffer;
  }

  uint64_t budget() const { return account_->budget; }
  uint64_t used() const { return account_->used; }
  uint64_t peak() const { return account_->peak; }
  /// Bytes that are left of the budget.
  uint64_t available() const { return account_->budget - account_->used; }
  /// Bytes of the largest buffer that could be allocated now: what is left,
  /// and no more than the device's limit.
  uint64_t largest() const { return std::min(available(), context_.device().max_allocation); }

 private:
  DeviceContext& context_;
  std::shared_ptr<detail::MemoryAccount> account_;
};

}  // namespace kiloband::opencl
