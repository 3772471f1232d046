#include "src_gpu/device/context.hpp"

#include <algorithm>
#include <utility>

namespace kiloband::opencl {
namespace {

/// Releases what `object` refers to; unlike an assignment, never an exception. A lost device may fail at it.
template <class T>
void drop(T& object) noexcept {
  T dead;
  std::swap(dead, object);
}

}  // namespace

DeviceContext::DeviceContext(DeviceInfo device, ContextOptions options)
    : device_(std::move(device)), options_(options) {
  create();
}

void DeviceContext::create() {
  checked(site(Phase::kSetup), [&] {
    const cl::Device device = cl_device();
    context_ = cl::Context(device);
    queue_ = cl::CommandQueue(context_, device, options_.profiling ? CL_QUEUE_PROFILING_ENABLE : 0);
  });
}

/// Of a lost device an error is expected, and no news.
void DeviceContext::settle() noexcept {
  if (queue_()) clFinish(queue_());
}

void DeviceContext::rebuild() {
  ++generation_;
  settle();
  launches_.clear();
  programs_.clear();
  drop(queue_);
  drop(context_);
  create();
}

void DeviceContext::finish() {
  count_wait();
  checked(site(Phase::kRun), [&] { queue_.finish(); });
}

double DeviceContext::take_longest(LaunchScale scale) {
  double longest = 0;
  for (const Launch& launch : launches_) {
    if (launch.scale != scale) continue;
    const double seconds = seconds_of(*this, launch.event);
    longest = std::max(longest, seconds);
    kernel_seconds_[launch.kernel] += seconds;
    ++kernel_launches_[launch.kernel];
  }
  std::erase_if(launches_, [&](const Launch& launch) { return launch.scale == scale; });
  return longest;
}

double seconds_of(const DeviceContext& context, const cl::Event& event) {
  if (event() == nullptr) return 0;
  return checked(context.site(Phase::kRun), [&] {
    const cl_ulong start = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
    const cl_ulong end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
    return static_cast<double>(end - start) * 1e-9;
  });
}

void DeviceContext::flush() {
  checked(site(Phase::kRun), [&] { queue_.flush(); });
}

}  // namespace kiloband::opencl
