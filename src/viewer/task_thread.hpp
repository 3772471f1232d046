// A thread that works step by step, and does what others ask between the steps.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

namespace kiloband::viewer {

class TaskThread {
 public:
  /// step: some work, on the thread; false: there is no more until a task was done. Throws nothing.
  explicit TaskThread(std::function<bool()> step);
  /// Waits for the end of the step.
  ~TaskThread();

  /// Has the task done between two steps, and waits for that. Tasks are done in order.
  /// throws what the task throws; std::runtime_error  the thread is ending
  void perform(std::function<void()> task);

 private:
  void run();

  std::function<bool()> step_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::packaged_task<void()>> tasks_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace kiloband::viewer
