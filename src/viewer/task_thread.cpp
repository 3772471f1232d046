#include "viewer/task_thread.hpp"

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

void TaskThread::run() {
  bool works = true;
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return works || ending_ || !tasks_.empty(); });
    while (!tasks_.empty()) {
      std::packaged_task<void()> task = std::move(tasks_.front());
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
