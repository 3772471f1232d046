#include "render/devices/device_group.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <type_traits>

#include "base/error.hpp"
#include "base/threads.hpp"
#include "render/devices/block_queue.hpp"
#include "render/devices/group_info.hpp"
#include "render/devices/staged_sums.hpp"

namespace kiloband {
namespace {

using Clock = std::chrono::steady_clock;

/// What blocks on their way into a film with sums of another rule may take.
constexpr std::size_t kStagedBytes = std::size_t{256} << 20;

class DeviceGroup final : public Backend {
 public:
  DeviceGroup(std::vector<std::unique_ptr<Backend>> backends, DiagnosticSink sink);

  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) override;
  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) override {
    return of_first([&](Backend& backend) { return backend.auxiliary(rect); });
  }
  std::vector<TracedPath> trace(const PixelRect& rect, const SampleRange& range) override {
    return of_first([&](Backend& backend) { return backend.trace(rect, range); });
  }
  void camera_moved() override;

  BackendInfo info() const override { return info_; }
  BackendStatistics statistics() const override;
  std::vector<double> film_scale() const override { return backends_.front()->film_scale(); }
  SumRule sum_rule() const override { return rule_; }
  uint32_t blocks_at_once(uint32_t samples) const override;

 private:
  struct Run;

  bool works(std::size_t device) const { return loads_[device].works; }
  bool any_works() const {
    return std::ranges::any_of(loads_, [](const DeviceLoad& load) { return load.works; });
  }
  void start(Run& run);
  void work(std::size_t device, Run& run);
  void render_blocks(std::size_t device, Run& run, const std::vector<uint32_t>& blocks);
  double speed_after(std::size_t device, const Run& run, std::size_t pixels, double seconds);
  void leave_out(std::size_t device, const DeviceError& failure);
  void give_back(std::size_t device, Run& run, const std::vector<uint32_t>& blocks);
  void forget_slowness(const Run& run);
  template <class Work>
  std::invoke_result_t<Work, Backend&> of_first(const Work& work);

  std::vector<std::unique_ptr<Backend>> backends_;
  DiagnosticSink sink_;
  std::vector<SumRule> rules_;  // of the backends; one that has failed is not asked any more
  SumRule rule_;
  BackendInfo info_;
  std::vector<DeviceLoad> loads_;
  std::vector<uint32_t> jobs_;  // that were delivered, over all renders
  std::vector<double> busy_seconds_;
  std::vector<std::string> failures_;
  std::exception_ptr last_failure_;
  std::mutex mutex_;  // of the five above but for loads_, and of a run's progress
};

/// One render().
struct DeviceGroup::Run {
  Run(SpectralFilm& to, const SampleRange& samples, const std::vector<uint32_t>& blocks,
      const std::atomic<bool>& interruption, const std::function<void(uint64_t)>& on_progress,
      std::vector<DeviceLoad>& loads, std::size_t most_blocks)
      : film(to),
        range(samples),
        stop(interruption),
        progress(on_progress),
        queue(blocks, loads, most_blocks),
        reported(loads.size()),
        idle(loads.size(), 1) {}

  SpectralFilm& film;
  const SampleRange& range;
  const std::atomic<bool>& stop;
  const std::function<void(uint64_t)>& progress;
  BlockQueue queue;
  std::vector<uint64_t> reported;  // [device]: pixel samples of what it has in hand
  std::vector<char> idle;          // [device]: it has had no block
  uint64_t owed = 0;               // reported of blocks that were given back
  std::exception_ptr bug;          // what was no DeviceError

  std::size_t pixels_of(const std::vector<uint32_t>& blocks) const {
    std::size_t pixels = 0;
    for (const uint32_t block : blocks) pixels += film.blocks()[block].pixels();
    return pixels;
  }
  /// Whether the film has the range's samples of the block, as far as they were rendered.
  bool has(uint32_t block) const {
    return film.keeps_sums() ? film.attempted(range.replicate, block) != range.first
                             : film.has(range.replicate, block);
  }
};

DeviceGroup::DeviceGroup(std::vector<std::unique_ptr<Backend>> backends, DiagnosticSink sink)
    : backends_(std::move(backends)),
      sink_(std::move(sink)),
      loads_(backends_.size()),
      jobs_(backends_.size()),
      busy_seconds_(backends_.size()),
      failures_(backends_.size()) {
  std::vector<BackendInfo> infos;
  for (const auto& backend : backends_) {
    rules_.push_back(backend->sum_rule());
    infos.push_back(backend->info());
  }
  info_ = joined_info(infos);
  const bool one_rule =
      std::ranges::all_of(rules_, [&](const SumRule& rule) { return rule == rules_.front(); });
  rule_ = one_rule ? rules_.front() : kStagedRule;
  if (!of_one_kind(infos))
    note(sink_, {}, "devices of several kinds: the last bits of the image depend on which renders what");
}

void DeviceGroup::render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
                         const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) {
  if (!any_works()) std::rethrow_exception(last_failure_);
  const std::size_t staged = kStagedBytes / staged_bytes_of_block(film.options().channels);
  const std::size_t most = rule_ == kStagedRule && film.keeps_sums()
                               ? std::max<std::size_t>(staged, 1)
                               : std::numeric_limits<std::size_t>::max();
  for (std::size_t d = 0; d < backends_.size(); ++d)
    if (works(d)) loads_[d].at_once = backends_[d]->blocks_at_once(range.count);
  Run run(film, range, blocks, stop, progress, loads_, most);
  start(run);
  if (run.bug) std::rethrow_exception(run.bug);
  if (!any_works()) std::rethrow_exception(last_failure_);
  forget_slowness(run);
}

/// A thread per device; the last device has the caller's.
void DeviceGroup::start(Run& run) {
  std::vector<std::size_t> working;
  for (std::size_t d = 0; d < backends_.size(); ++d)
    if (works(d)) working.push_back(d);
  std::vector<std::jthread> threads;
  try {
    for (std::size_t i = 0; i + 1 < working.size(); ++i)
      threads.emplace_back([this, &run, d = working[i]] { work(d, run); });
  } catch (const std::system_error&) {
    run.queue.close();
    throw DeviceError("a thread for each device: " + thread_limit_text());
  }
  work(working.back(), run);
}

void DeviceGroup::work(std::size_t device, Run& run) {
  for (;;) {
    const std::vector<uint32_t> blocks = run.queue.take(device, run.stop);
    if (blocks.empty()) return;
    try {
      const auto begin = Clock::now();
      render_blocks(device, run, blocks);
      const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      run.queue.done(device, speed_after(device, run, run.pixels_of(blocks), seconds));
    } catch (const DeviceError& failure) {
      leave_out(device, failure);
      return give_back(device, run, blocks);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!run.bug) run.bug = std::current_exception();
      return run.queue.close();
    }
  }
}

void DeviceGroup::render_blocks(std::size_t device, Run& run, const std::vector<uint32_t>& blocks) {
  run.reported[device] = 0;
  run.idle[device] = 0;
  const auto on_samples = [&](uint64_t samples) {
    const std::lock_guard lock(mutex_);
    run.reported[device] += samples;
    const uint64_t again = std::min(samples, run.owed);
    run.owed -= again;
    if (run.progress && samples > again) run.progress(samples - again);
  };
  Backend& backend = *backends_[device];
  if (run.film.keeps_sums() && rules_[device] != rule_)
    return render_staged(backend, rules_[device], run.film, run.range, blocks, run.stop, on_samples);
  backend.render(run.film, run.range, blocks, run.stop, on_samples);
}

/// Pixel samples per second. The first job of a device also compiles kernels and starts threads: it tells nothing.
double DeviceGroup::speed_after(std::size_t device, const Run& run, std::size_t pixels, double seconds) {
  const std::lock_guard lock(mutex_);
  busy_seconds_[device] += seconds;
  if (++jobs_[device] == 1 || run.stop || seconds <= 0) return loads_[device].speed;
  return static_cast<double>(pixels) * run.range.count / seconds;
}

void DeviceGroup::leave_out(std::size_t device, const DeviceError& failure) {
  const std::lock_guard lock(mutex_);
  failures_[device] = failure.what();
  last_failure_ = std::current_exception();
  const auto others = std::ranges::count_if(failures_, &std::string::empty);
  if (others == 0) return;  // what it says ends the render
  warn(sink_, {},
       fmt::format("{}: device {} of {} is left out, its work goes to the others", failure.what(), device + 1,
                   backends_.size()));
}

/// What the film lacks of the device's blocks goes back to the queue. Their samples will be reported once more.
void DeviceGroup::give_back(std::size_t device, Run& run, const std::vector<uint32_t>& blocks) {
  std::vector<uint32_t> back, delivered;
  for (const uint32_t block : blocks) (run.has(block) ? delivered : back).push_back(block);
  {
    const std::lock_guard lock(mutex_);
    const uint64_t kept = uint64_t{run.pixels_of(delivered)} * run.range.count;
    run.owed += run.reported[device] - std::min(kept, run.reported[device]);
  }
  run.queue.failed(device, back);
}

/// A device that was thought too slow for any block may have been measured at a bad moment: it is given another chance.
void DeviceGroup::forget_slowness(const Run& run) {
  for (std::size_t d = 0; d < loads_.size(); ++d)
    if (run.idle[d] != 0) loads_[d].speed *= 2;
}

/// The answer of the first device that works.
template <class Work>
std::invoke_result_t<Work, Backend&> DeviceGroup::of_first(const Work& work) {
  for (std::size_t d = 0; d < backends_.size(); ++d) {
    if (!works(d)) continue;
    try {
      return work(*backends_[d]);
    } catch (const DeviceError& failure) {
      leave_out(d, failure);
      loads_[d].works = false;
    }
  }
  std::rethrow_exception(last_failure_);
}

void DeviceGroup::camera_moved() {
  for (std::size_t d = 0; d < backends_.size(); ++d) {
    if (!works(d)) continue;
    try {
      backends_[d]->camera_moved();
    } catch (const DeviceError& failure) {
      leave_out(d, failure);
      loads_[d].works = false;
    }
  }
  if (!any_works()) std::rethrow_exception(last_failure_);
}

uint32_t DeviceGroup::blocks_at_once(uint32_t samples) const {
  uint32_t sum = 0;
  for (std::size_t d = 0; d < backends_.size(); ++d)
    if (works(d)) sum += backends_[d]->blocks_at_once(samples);
  return sum;
}

BackendStatistics DeviceGroup::statistics() const {
  BackendStatistics sum;
  for (std::size_t d = 0; d < backends_.size(); ++d) {
    const BackendStatistics one = backends_[d]->statistics();
    const BackendInfo info = backends_[d]->info();
    add_statistics(sum, one);
    sum.devices.push_back({info.name, info.device, one.paths, busy_seconds_[d], failures_[d]});
  }
  return sum;
}

}  // namespace

std::unique_ptr<Backend> make_device_group(std::vector<std::unique_ptr<Backend>> backends,
                                           DiagnosticSink sink) {
  if (backends.empty()) throw std::logic_error("make_device_group: no backend");
  return std::make_unique<DeviceGroup>(std::move(backends), std::move(sink));
}

}  // namespace kiloband
