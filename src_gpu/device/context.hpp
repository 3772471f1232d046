// One device in use: context, in-order queue and the programs built for it.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src_gpu/device/device.hpp"
#include "src_gpu/device/errors.hpp"

namespace kiloband::opencl {

struct ContextOptions {
  bool profiling = false;  // events of the queue carry times: Kernel::launch_timed
  bool shared =
      false;  // cl::Context and built programs are those of all who share the device (shared_programs)
};

/// A cl::Context and the programs built in it last. For any thread.
class ContextPrograms {
 public:
  explicit ContextPrograms(cl::Context context) : context_(std::move(context)) {}

  const cl::Context& context() const { return context_; }
  /// The program kept under `key`: the hash of source and options.
  std::optional<cl::Program> find(const std::string& key) const;
  /// Keeps it; of more than kMost the one that was kept first goes. Kernels made from it remain valid.
  void keep(const std::string& key, const cl::Program& program);

  static constexpr std::size_t kMost = 24;  // of PoCL a MiB or two each

 private:
  cl::Context context_;
  mutable std::mutex mutex_;
  std::deque<std::pair<std::string, cl::Program>> kept_;
};

/// What those who share a device have in common: made at the first call, there until the process ends or it is
/// forgotten. A part of a device has its own, which nobody else gets.
/// throws DeviceError
std::shared_ptr<ContextPrograms> shared_programs(const DeviceInfo& device);
/// After a loss: the next call of shared_programs() makes another. Nothing where that has happened already.
void forget_shared(const DeviceInfo& device, const std::shared_ptr<ContextPrograms>& lost);

/// What the time of a kernel's launches grows with: slots of the pool, paths of a round, or neither.
enum class LaunchScale { kOther, kSlots, kPaths };

/// Not copied: buffers, programs and kernels refer to it. One thread at a time uses it.
class DeviceContext {
 public:
  /// throws DeviceError
  explicit DeviceContext(DeviceInfo device, ContextOptions options = {});
  /// Waits for what is enqueued: drivers that still work when the process ends may crash it (PoCL compiles
  /// kernels in threads of its own).
  ~DeviceContext() { settle(); }
  DeviceContext(const DeviceContext&) = delete;
  DeviceContext& operator=(const DeviceContext&) = delete;

  /// After DeviceLost: a new context and queue, without the programs of the old one. Buffers, programs and kernels of the old
  /// one are useless from now on; destroying them remains valid, before or after.
  void rebuild();

  /// After DeviceLost, where it is not rebuilt: nobody else gets the lost context.
  void abandon() { forget_shared(device_, programs_); }

  /// Waits until everything enqueued is done, whatever comes of it.
  void settle() noexcept;
  /// The same.
  /// throws DeviceLost, DeviceOutOfMemory, DeviceError
  void finish();
  /// Hands what is enqueued to the device, without waiting.
  void flush();

  const DeviceInfo& device() const { return device_; }
  const ContextOptions& options() const { return options_; }
  const cl::Context& context() const { return programs().context(); }
  cl::CommandQueue& queue() { return queue_; }
  cl::Device cl_device() const { return cl::Device(device_.id, true); }
  /// How often it was rebuilt.
  uint32_t generation() const { return generation_; }

  /// How often the host has waited for the device: transfers and finish().
  uint64_t waits() const { return waits_; }
  void count_wait() { ++waits_; }

  /// A site for errors of this device.
  CallSite site(Phase phase, std::string subject = {}) const {
    return {phase, device_.name, std::move(subject)};
  }

  /// Notes a launch for take_longest(); only with profiling.
  void record(LaunchScale scale, const std::string& kernel, cl::Event event) {
    launches_.push_back({scale, kernel, std::move(event)});
  }
  /// Longest of the launches of this scale since the last look, seconds on the device; 0 without any. The
  /// queue must have been waited for.
  /// throws DeviceLost, DeviceError
  double take_longest(LaunchScale scale);
  /// Seconds on the device by kernel, of all launches that take_longest() has seen.
  const std::map<std::string, double>& kernel_seconds() const { return kernel_seconds_; }
  /// Their number.
  const std::map<std::string, uint64_t>& kernel_launches() const { return kernel_launches_; }

  /// Built programs; build_program looks here first.
  /// throws DeviceError  rebuild() has failed: there is no context
  ContextPrograms& programs() const;

  /// Why built programs could not be kept on disk, the first time; empty: no reason, or not tried.
  const std::string& cache_problem() const { return cache_problem_; }
  void note_cache_problem(const std::string& problem) {
    if (cache_problem_.empty()) cache_problem_ = problem;
  }

 private:
  void create();

  DeviceInfo device_;
  ContextOptions options_;
  std::shared_ptr<ContextPrograms> programs_;
  cl::CommandQueue queue_;
  std::string cache_problem_;
  struct Launch {
    LaunchScale scale;
    std::string kernel;
    cl::Event event;
  };
  std::vector<Launch> launches_;
  std::map<std::string, double> kernel_seconds_;
  std::map<std::string, uint64_t> kernel_launches_;
  uint32_t generation_ = 0;
  uint64_t waits_ = 0;
};

/// Seconds on the device, of a launch that is done; 0 for one that had no items.
/// throws DeviceLost, DeviceError
double seconds_of(const DeviceContext& context, const cl::Event& event);

}  // namespace kiloband::opencl
