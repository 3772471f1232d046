#include "src_gpu/evaluate/pinned_memory.hpp"

namespace kiloband::opencl {

PinnedFloats::PinnedFloats(DeviceContext& context, uint64_t count)
    : context_(context), generation_(context.generation()) {
  const uint64_t bytes = count * sizeof(float);
  checked(context.site(Phase::kAllocate, "pinned memory"), [&] {
    buffer_ = cl::Buffer(context.context(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
    void* const start =
        context.queue().enqueueMapBuffer(buffer_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes);
    values_ = {static_cast<float*>(start), count};
  });
}

/// A lost device may fail at it; a context that was made anew has nothing to do with it.
PinnedFloats::~PinnedFloats() {
  if (generation_ != context_.generation()) return;
  context_.settle();  // a transfer may be under way
  clEnqueueUnmapMemObject(context_.queue()(), buffer_(), values_.data(), 0, nullptr, nullptr);
  context_.settle();
}

}  // namespace kiloband::opencl
