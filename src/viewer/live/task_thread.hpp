// A thread that works step by step, and does what others ask between the steps.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

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
  /// The same as soon as `ready`, which is asked on the thread between two steps, says so. False: it did not within `most`.
  bool perform_when(std::function<bool()> ready, std::function<void()> task, std::chrono::milliseconds most);

 private:
  using Task = std::packaged_task<void()>;
  struct Waiting {
    std::function<bool()> ready;
    Task task;
  };

  void run();
  void take_ready();

  std::function<bool()> step_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> tasks_;
  std::vector<std::shared_ptr<Waiting>> waiting_;
  bool asked_ = false;  // there are new ones that wait
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace kiloband::viewer
