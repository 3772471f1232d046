#include "src_gpu/device/memory.hpp"

#include <cstdio>
#include <stdexcept>

namespace kiloband::opencl {
namespace {

constexpr uint64_t kSmallest = 4;  // bytes

/// "3.20 GiB", "17.0 MiB", "12 bytes"
std::string size_text(uint64_t bytes) {
  constexpr double kKibi = 1024.0;
  const double value = static_cast<double>(bytes);
  char text[32];
  if (value >= kKibi * kKibi * kKibi) {
    std::snprintf(text, sizeof text, "%.2f GiB", value / (kKibi * kKibi * kKibi));
  } else if (value >= kKibi * kKibi) {
    std::snprintf(text, sizeof text, "%.1f MiB", value / (kKibi * kKibi));
  } else {
    std::snprintf(text, sizeof text, "%llu bytes", static_cast<unsigned long long>(bytes));
  }
  return text;
}

std::string request_text(const std::string& what, uint64_t bytes, const detail::MemoryAccount& account) {
  return "buffer '" + what + "' of " + size_text(bytes) + " (" + size_text(account.used) +
         " of a budget of " + size_text(account.budget) + " in use)";
}

/// Allocation is lazy in some drivers (NVIDIA): the failure would come at the first launch that uses the
/// buffer, where nothing tells it from a crash. So that it comes here, what was enqueued before is finished
/// first, and the buffer is touched at once. A few bytes are enough to make a driver place the whole buffer.
cl::Buffer create_touched(DeviceContext& context, const std::string& request, uint64_t bytes) {
  context.finish();
  return checked(context.site(Phase::kAllocate, request), [&] {
    cl::Buffer buffer(context.context(), CL_MEM_READ_WRITE, bytes);
    context.queue().enqueueFillBuffer(buffer, cl_uint{0}, 0, kSmallest);
    context.queue().finish();
    return buffer;
  });
}

}  // namespace

uint64_t default_memory_budget(const DeviceInfo& device) {
  if (device.type != DeviceType::kCpu) return device.global_memory / 10 * 7;
  return std::min(device.global_memory / 4, uint64_t{2} << 30);
}

DeviceMemory::DeviceMemory(DeviceContext& context, std::optional<uint64_t> budget)
    : context_(context), account_(std::make_shared<detail::MemoryAccount>()) {
  account_->budget = budget.value_or(default_memory_budget(context.device()));
}

namespace detail {

RawBuffer::RawBuffer(DeviceContext& context, std::shared_ptr<MemoryAccount> account, std::string what,
                     uint64_t bytes)
    : context_(&context), account_(std::move(account)), what_(std::move(what)), bytes_(bytes) {
  const uint64_t claimed = std::max(bytes, kSmallest);
  const std::string request = request_text(what_, bytes, *account_);
  const DeviceInfo& device = context.device();
  if (claimed > account_->budget - account_->used) {
    throw DeviceOutOfMemory("device '" + device.name + "': no memory for " + request);
  }
  if (claimed > device.max_allocation) {
    throw DeviceOutOfMemory("device '" + device.name + "': no memory for " + request + ": no buffer beyond " +
                            size_text(device.max_allocation) + " is possible");
  }
  buffer_ = create_touched(context, request, claimed);
  charged_ = claimed;
  account_->used += charged_;
  account_->peak = std::max(account_->peak, account_->used);
}

void RawBuffer::release() noexcept {
  cl::Buffer dead;
  std::swap(dead, buffer_);  // an assignment would throw where the device is lost
  if (account_) account_->used -= charged_;
  account_.reset();
  bytes_ = charged_ = 0;
}

void RawBuffer::swap(RawBuffer& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(account_, other.account_);
  std::swap(what_, other.what_);
  std::swap(bytes_, other.bytes_);
  std::swap(charged_, other.charged_);
  std::swap(buffer_, other.buffer_);
}

void RawBuffer::check_range(uint64_t offset, uint64_t bytes) const {
  if (offset <= bytes_ && bytes <= bytes_ - offset) return;
  throw std::logic_error("buffer '" + what_ + "' has " + std::to_string(bytes_) + " bytes: " +
                         std::to_string(bytes) + " from " + std::to_string(offset) + " on were asked for");
}

CallSite RawBuffer::site() const {
  return context_->site(Phase::kRun, "buffer '" + what_ + "'");
}

void RawBuffer::write(uint64_t offset, uint64_t bytes, const void* from, bool wait) {
  check_range(offset, bytes);
  if (bytes == 0) return;
  if (wait) context_->count_wait();
  checked(site(), [&] { context_->queue().enqueueWriteBuffer(buffer_, wait, offset, bytes, from); });
}

void RawBuffer::read(uint64_t offset, uint64_t bytes, void* to, bool wait) const {
  check_range(offset, bytes);
  if (bytes == 0) return;
  if (wait) context_->count_wait();
  checked(site(), [&] { context_->queue().enqueueReadBuffer(buffer_, wait, offset, bytes, to); });
}

cl::Event RawBuffer::read_event(uint64_t offset, uint64_t bytes, void* to) const {
  check_range(offset, bytes);
  cl::Event event;
  checked(site(), [&] {
    context_->queue().enqueueReadBuffer(buffer_, CL_FALSE, offset, bytes, to, nullptr, &event);
    context_->queue().flush();
  });
  return event;
}

void RawBuffer::wait_for(const cl::Event& event) const {
  context_->count_wait();
  checked(site(), [&] { event.wait(); });
}

void RawBuffer::fill(uint64_t offset, uint64_t bytes, const void* pattern, uint64_t pattern_bytes) {
  check_range(offset, bytes);
  if (bytes == 0) return;
  checked(site(), [&] {
    const cl_int code = clEnqueueFillBuffer(context_->queue()(), buffer_(), pattern, pattern_bytes, offset,
                                            bytes, 0, nullptr, nullptr);
    if (code != CL_SUCCESS) throw cl::Error(code, "clEnqueueFillBuffer");
  });
}

}  // namespace detail
}  // namespace kiloband::opencl
