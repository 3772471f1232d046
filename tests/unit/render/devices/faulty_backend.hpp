// A backend that fails when it is told to.
#pragma once

#include <atomic>
#include <chrono>
#include <latch>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "render/backend.hpp"

namespace kiloband::test {

/// What goes wrong, and when.
struct Fault {
  enum class Kind { kNone, kDevice, kBug } kind = Kind::kNone;
  int at_call = 1;            // of render(), from 1: that call and all later ones
  std::size_t delivered = 0;  // blocks that this call delivers before it fails
  bool auxiliary = false;     // auxiliary(), trace() and camera_moved() fail, too
};

/// Another backend with a fault.
class FaultyBackend final : public Backend {
 public:
  FaultyBackend(std::unique_ptr<Backend> backend, const Fault& fault, std::string name = "faulty")
      : backend_(std::move(backend)), fault_(fault), name_(std::move(name)) {}

  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) override {
    while (waits_for_ && !*waits_for_) std::this_thread::yield();
    if (const auto all = std::exchange(meeting_, nullptr)) meet(*all);
    const bool fails = fault_.kind != Fault::Kind::kNone && ++calls_ >= fault_.at_call;
    if (!fails) return backend_->render(film, range, blocks, stop, progress);
    const auto end = blocks.begin() + static_cast<std::ptrdiff_t>(std::min(fault_.delivered, blocks.size()));
    backend_->render(film, range, {blocks.begin(), end}, stop, progress);
    if (progress) progress(1);  // of a block that is never delivered
    *failed_ = true;
    if (fault_.kind == Fault::Kind::kBug) throw std::logic_error("a bug");
    throw DeviceError(name_ + ": lost");
  }
  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) override {
    check();
    return backend_->auxiliary(rect);
  }
  std::vector<TracedPath> trace(const PixelRect& rect, const SampleRange& range) override {
    check();
    return backend_->trace(rect, range);
  }
  void camera_moved() override {
    check();
    backend_->camera_moved();
  }
  BackendInfo info() const override { return backend_->info(); }
  BackendStatistics statistics() const override { return backend_->statistics(); }
  std::vector<double> film_scale() const override { return backend_->film_scale(); }
  SumRule sum_rule() const override { return rule_.value_or(backend_->sum_rule()); }
  uint32_t blocks_at_once(uint32_t samples) const override { return backend_->blocks_at_once(samples); }

  /// Renders nothing before the other has failed, so that it does.
  void wait_for(const FaultyBackend& other) { waits_for_ = other.failed_; }

  /// Its first render() begins when as many backends as the latch counts have been given something to render, or
  /// after a minute.
  void meet_at(std::shared_ptr<std::latch> all) { meeting_ = std::move(all); }

  /// One that keeps the film as the backend does, and is another for all that.
  void claim_other_rule() {
    rule_ = backend_->sum_rule();
    rule_->step = 2;
  }

 private:
  static void meet(std::latch& all) {
    using Clock = std::chrono::steady_clock;
    all.count_down();
    for (const auto end = Clock::now() + std::chrono::minutes(1); !all.try_wait() && Clock::now() < end;)
      std::this_thread::yield();
  }
  void check() const {
    if (fault_.auxiliary) throw DeviceError(name_ + ": lost");
  }

  std::unique_ptr<Backend> backend_;
  Fault fault_;
  std::string name_;
  std::optional<SumRule> rule_;
  int calls_ = 0;
  std::shared_ptr<std::atomic<bool>> failed_ = std::make_shared<std::atomic<bool>>(false), waits_for_;
  std::shared_ptr<std::latch> meeting_;
};

}  // namespace kiloband::test
