#include "src_gpu/context.hpp"

#include <utility>

namespace kiloband::gpu {
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
  programs_.clear();
  drop(queue_);
  drop(context_);
  create();
}

void DeviceContext::finish() {
  checked(site(Phase::kRun), [&] { queue_.finish(); });
}

void DeviceContext::flush() {
  checked(site(Phase::kRun), [&] { queue_.flush(); });
}

}  // namespace kiloband::gpu
