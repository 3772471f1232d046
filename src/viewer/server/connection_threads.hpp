// Threads for connections, one each, up to a limit.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "viewer/server/httplib.hpp"

namespace kiloband::viewer {

/// Connections beyond the limit are not queued: their function runs at once, on the caller's thread, where is_refusing() says
/// that there is nothing to do but to refuse.
class ConnectionThreads final : public httplib::TaskQueue {
 public:
  explicit ConnectionThreads(std::size_t most) : most_(most) {}
  ~ConnectionThreads() override { shutdown(); }

  void enqueue(std::function<void()> serve) override;
  void shutdown() override;
  static bool is_refusing();
  /// More than half of the connections there may be are open.
  bool is_crowded();

 private:
  bool accept(const std::function<void()>& serve);
  void work();

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> waiting_;
  std::size_t busy_ = 0;  // connections that are served or waiting
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace kiloband::viewer
