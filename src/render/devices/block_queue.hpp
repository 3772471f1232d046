// The blocks of one render, handed out to devices as they become free.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <span>
#include <vector>

#include "render/devices/job_size.hpp"

namespace kiloband {

/// Every block is with one device at most; one that fails gives back what it has not delivered. All functions may be
/// called by several threads.
class BlockQueue {
 public:
  /// loads  of all devices, kept up to date; most  blocks that are handed out at a time. Both must outlive the queue.
  BlockQueue(std::span<const uint32_t> blocks, std::vector<DeviceLoad>& loads, std::size_t most);

  /// The next blocks of device `which`; waits while others may give some back. Empty: there will be none for it, or
  /// `stop` is true.
  std::vector<uint32_t> take(std::size_t which, const std::atomic<bool>& stop);
  /// The device has delivered what it took. speed: what it now is known to have, as DeviceLoad's.
  void done(std::size_t which, double speed);
  /// The device works no more; `back` was not delivered.
  void failed(std::size_t which, std::span<const uint32_t> back);
  /// Nothing more is handed out.
  void close();

  /// Blocks that nobody has taken.
  std::size_t left() const;

 private:
  bool others_work_on(std::size_t which) const;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<uint32_t> blocks_;
  std::vector<DeviceLoad>& loads_;
  const std::size_t most_;
  bool closed_ = false;
};

}  // namespace kiloband
