#include "viewer/server/connection_threads.hpp"

#include <system_error>
#include <utility>

namespace kiloband::viewer {
namespace {

thread_local bool refusing = false;

}  // namespace

bool ConnectionThreads::is_refusing() {
  return refusing;
}

void ConnectionThreads::enqueue(std::function<void()> serve) {
  if (accept(serve)) return;
  refusing = true;
  serve();
  refusing = false;
}

bool ConnectionThreads::accept(const std::function<void()>& serve) {
  const std::lock_guard lock(mutex_);
  if (ending_ || busy_ >= most_) return false;
  if (busy_ >= threads_.size()) {
    try {
      threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {  // the system starts no more
      if (busy_ >= threads_.size()) return false;
    }
  }
  ++busy_;
  waiting_.push_back(serve);
  wake_.notify_one();
  return true;
}

bool ConnectionThreads::is_crowded() {
  const std::lock_guard lock(mutex_);
  return busy_ > most_ / 2;
}

void ConnectionThreads::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::function<void()> serve = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    serve();
    lock.lock();
    --busy_;
  }
}

void ConnectionThreads::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

}  // namespace kiloband::viewer
