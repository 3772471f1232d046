#include "viewer/live/task_thread.hpp"

#include <stdexcept>
#include <utility>

namespace kiloband::viewer {

TaskThread::TaskThread(std::function<bool()> step) : step_(std::move(step)), thread_([this] { run(); }) {}

TaskThread::~TaskThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void TaskThread::perform(std::function<void()> task) {
  std::packaged_task<void()> packaged(std::move(task));
  std::future<void> done = packaged.get_future();
  {
    const std::lock_guard lock(mutex_);
    if (ending_) throw std::runtime_error("the viewer is ending");
    tasks_.push_back(std::move(packaged));
  }
  wake_.notify_all();
  done.get();
}

bool TaskThread::perform_when(std::function<bool()> ready, std::function<void()> task,
                              std::chrono::milliseconds most) {
  const auto waiting = std::make_shared<Waiting>(Waiting{std::move(ready), Task(std::move(task))});
  std::future<void> done = waiting->task.get_future();
  {
    const std::lock_guard lock(mutex_);
    if (ending_) throw std::runtime_error("the viewer is ending");
    waiting_.push_back(waiting);
    asked_ = true;
  }
  wake_.notify_all();
  if (done.wait_for(most) == std::future_status::timeout) {
    const std::lock_guard lock(mutex_);
    if (std::erase(waiting_, waiting) > 0) return false;
  }
  done.get();
  return true;
}

/// With the lock held.
void TaskThread::take_ready() {
  asked_ = false;
  std::erase_if(waiting_, [this](const std::shared_ptr<Waiting>& waiting) {
    const bool ready = waiting->ready();
    if (ready) tasks_.push_back(std::move(waiting->task));
    return ready;
  });
}

void TaskThread::run() {
  bool works = true;
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return works || ending_ || asked_ || !tasks_.empty(); });
    take_ready();
    while (!tasks_.empty()) {
      Task task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
      works = true;
    }
    if (ending_) return;
    lock.unlock();
    works = step_();
    lock.lock();
  }
}

}  // namespace kiloband::viewer
