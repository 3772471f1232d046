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

/// Never destroyed: when statics are, drivers may be gone.
struct SharedContexts {
  std::mutex mutex;
  std::map<cl_device_id, std::shared_ptr<ContextPrograms>> of_device;
};
SharedContexts& shared_contexts() {
  static SharedContexts* const kContexts = new SharedContexts;
  return *kContexts;
}

std::shared_ptr<ContextPrograms> new_context(const DeviceInfo& device) {
  return checked({Phase::kSetup, device.name, {}},
                 [&] { return std::make_shared<ContextPrograms>(cl::Context(cl::Device(device.id, true))); });
}

}  // namespace

std::optional<cl::Program> ContextPrograms::find(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [known, program] : kept_)
    if (known == key) return program;
  return std::nullopt;
}

void ContextPrograms::keep(const std::string& key, const cl::Program& program) {
  const std::lock_guard lock(mutex_);
  kept_.emplace_back(key, program);
  if (kept_.size() > kMost) kept_.pop_front();
}

std::shared_ptr<ContextPrograms> shared_programs(const DeviceInfo& device) {
  if (device.kept) return new_context(device);  // a part: its id is another's once it is gone
  SharedContexts& all = shared_contexts();
  const std::lock_guard lock(all.mutex);
  std::shared_ptr<ContextPrograms>& programs = all.of_device[device.id];
  if (!programs) programs = new_context(device);
  return programs;
}

void forget_shared(const DeviceInfo& device, const std::shared_ptr<ContextPrograms>& lost) {
  SharedContexts& all = shared_contexts();
  const std::lock_guard lock(all.mutex);
  const auto known = all.of_device.find(device.id);
  if (known != all.of_device.end() && known->second == lost) all.of_device.erase(known);
}

DeviceContext::DeviceContext(DeviceInfo device, ContextOptions options)
    : device_(std::move(device)), options_(options) {
  create();
}

void DeviceContext::create() {
  auto programs = options_.shared ? shared_programs(device_) : new_context(device_);
  checked(site(Phase::kSetup), [&] {
    queue_ = cl::CommandQueue(programs->context(), cl_device(),
                              options_.profiling ? CL_QUEUE_PROFILING_ENABLE : 0);
  });
  programs_ = std::move(programs);
}

ContextPrograms& DeviceContext::programs() const {
  if (!programs_) throw DeviceError("device '" + device_.name + "': was lost and could not be set up again");
  return *programs_;
}

/// Of a lost device an error is expected, and no news.
void DeviceContext::settle() noexcept {
  if (queue_()) clFinish(queue_());
}

void DeviceContext::rebuild() {
  ++generation_;
  settle();
  launches_.clear();
  drop(queue_);
  abandon();
  programs_.reset();
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
