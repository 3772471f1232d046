#include "src_gpu/device/kernel.hpp"

#include <algorithm>
#include <stdexcept>

namespace kiloband::opencl {
namespace {

uint64_t round_up(uint64_t items, uint64_t multiple) {
  return (items + multiple - 1) / multiple * multiple;
}

}  // namespace

Kernel::Kernel(DeviceContext& context, cl::Kernel kernel, std::string name)
    : context_(&context), kernel_(std::move(kernel)), name_(std::move(name)) {
  checked(site(Phase::kSetup), [&] {
    const cl::Device device = context_->cl_device();
    argument_count_ = kernel_.getInfo<CL_KERNEL_NUM_ARGS>();
    max_work_group_size_ = kernel_.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(device);
  });
}

CallSite Kernel::site(Phase phase) const {
  return context_->site(phase, "kernel '" + name_ + "'");
}

void Kernel::check_count(uint64_t count) const {
  if (count == argument_count_) return;
  throw std::logic_error("kernel '" + name_ + "' has " + std::to_string(argument_count_) +
                         " arguments, got " + std::to_string(count));
}

void Kernel::set_raw(uint32_t index, uint64_t bytes, const void* value) {
  try {
    kernel_.setArg(index, bytes, value);
  } catch (const cl::Error& e) {
    const std::string subject = "argument " + std::to_string(index) + " of kernel '" + name_ + "'";
    const bool ours = e.err() == CL_INVALID_ARG_INDEX || e.err() == CL_INVALID_ARG_SIZE ||
                      e.err() == CL_INVALID_ARG_VALUE || e.err() == CL_INVALID_MEM_OBJECT;
    if (ours)
      throw std::logic_error(error_message(context_->site(Phase::kSetup, subject), e.what(), e.err()));
    throw_device_error(context_->site(Phase::kSetup, subject), e.what(), e.err());
  }
}

cl::Event Kernel::launch_event(uint64_t items, uint64_t local) {
  cl::Event event;
  enqueue(items, local, 0, &event);
  return event;
}

void Kernel::launch(uint64_t items, uint64_t local, uint64_t first) {
  enqueue(items, local, first, nullptr);
}

double Kernel::launch_timed(uint64_t items, uint64_t local) {
  if (items == 0) return 0;
  const cl::Event event = launch_event(items, local);
  checked(site(Phase::kRun), [&] { event.wait(); });
  return seconds_of(*context_, event);
}

void Kernel::enqueue(uint64_t items, uint64_t local, uint64_t first, cl::Event* event) {
  if (items == 0) return;
  local = std::min(local, max_work_group_size_);
  const cl::NDRange global(local == 0 ? items : round_up(items, local));
  const cl::NDRange group = local == 0 ? cl::NullRange : cl::NDRange(local);
  cl::Event own;
  if (!event && context_->options().profiling) event = &own;
  checked(site(Phase::kRun), [&] {
    context_->queue().enqueueNDRangeKernel(kernel_, cl::NDRange(first), global, group, nullptr, event);
  });
  if (context_->options().profiling) context_->record(scale_, name_, *event);
}

}  // namespace kiloband::opencl
