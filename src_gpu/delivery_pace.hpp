// How often what a device has gathered comes to the host.
#pragma once

#include <algorithm>
#include <chrono>

namespace kiloband::opencl {

/// When what a device has gathered is brought to the host: seldom, by the time that it takes.
class DeliveryPace {
 public:
  bool is_due() const { return seconds_since(last_) > std::max(kSeconds, kTimesItself * seconds_); }
  template <class Work>
  void measured(const Work& work) {
    const Clock::time_point begin = Clock::now();
    work();
    last_ = Clock::now();
    seconds_ = std::chrono::duration<double>(last_ - begin).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kSeconds = 10, kTimesItself = 20;
  static double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }

  Clock::time_point last_ = Clock::now();
  double seconds_ = 0;
};

}  // namespace kiloband::opencl
