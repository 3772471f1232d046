#include "render/devices/block_queue.hpp"

#include <algorithm>

namespace kiloband {

BlockQueue::BlockQueue(std::span<const uint32_t> blocks, std::vector<DeviceLoad>& loads, std::size_t most)
    : blocks_(blocks.begin(), blocks.end()), loads_(loads), most_(most) {
  for (DeviceLoad& load : loads_) load.in_hand = 0;
}

bool BlockQueue::others_work_on(std::size_t which) const {
  for (std::size_t d = 0; d < loads_.size(); ++d)
    if (d != which && loads_[d].in_hand > 0) return true;
  return false;
}

std::vector<uint32_t> BlockQueue::take(std::size_t which, const std::atomic<bool>& stop) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (closed_ || stop) return {};
    const std::size_t wanted = blocks_.empty() ? 0 : blocks_to_take(loads_, which, blocks_.size());
    if (wanted > 0) {
      const auto end = blocks_.begin() + static_cast<std::ptrdiff_t>(std::min(wanted, most_));
      std::vector<uint32_t> taken(blocks_.begin(), end);
      blocks_.erase(blocks_.begin(), end);
      loads_[which].in_hand = taken.size();
      return taken;
    }
    if (blocks_.empty() && !others_work_on(which)) return {};
    changed_.wait(lock);
  }
}

void BlockQueue::done(std::size_t which, double speed) {
  const std::lock_guard lock(mutex_);
  loads_[which].in_hand = 0;
  loads_[which].speed = speed;
  changed_.notify_all();
}

void BlockQueue::failed(std::size_t which, std::span<const uint32_t> back) {
  const std::lock_guard lock(mutex_);
  loads_[which].in_hand = 0;
  loads_[which].works = false;
  blocks_.insert(blocks_.begin(), back.begin(), back.end());
  changed_.notify_all();
}

void BlockQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::size_t BlockQueue::left() const {
  const std::lock_guard lock(mutex_);
  return blocks_.size();
}

}  // namespace kiloband
