// Progress of work of which attempts may be lost.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

namespace kiloband::opencl {

/// Pixel samples, told as they are done: once, whatever attempts are lost.
class ToldSamples {
 public:
  explicit ToldSamples(std::function<void(uint64_t)> progress) : progress_(std::move(progress)) {}

  void begin_attempt() { done_ = delivered_; }
  void add(uint64_t samples) {
    done_ += samples;
    if (done_ <= told_ || !progress_) return;
    progress_(done_ - told_);
    told_ = done_;
  }
  /// What the attempt has done is kept.
  void deliver() { delivered_ = done_; }

 private:
  std::function<void(uint64_t)> progress_;
  uint64_t delivered_ = 0, done_ = 0, told_ = 0;
};

}  // namespace kiloband::opencl
