#include "base/threads.hpp"

#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <iterator>
#include <system_error>
#include <thread>
#include <vector>

#include "base/error.hpp"

namespace kiloband {
namespace {

std::string limit_text() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NPROC, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "ulimit -u: unlimited";
  return "ulimit -u: " + std::to_string(limit.rlim_cur);
}

/// Threads of this process that the system counts.
std::ptrdiff_t counted_threads() {
  std::error_code error;
  std::filesystem::directory_iterator tasks("/proc/self/task", error);
  return error ? 0 : std::distance(tasks, {});
}

/// A thread that has been joined counts for a moment longer: whoever starts one next would be refused.
void wait_until_gone(std::ptrdiff_t before) {
  for (int i = 0; i < 10'000 && counted_threads() > before; ++i)
    std::this_thread::sleep_for(std::chrono::microseconds(100));
}

}  // namespace

bool can_start_threads(unsigned count) {
  const std::ptrdiff_t before = counted_threads();
  std::promise<void> end;
  const std::shared_future<void> ended = end.get_future().share();
  std::vector<std::thread> threads;
  bool all = true;
  try {
    for (unsigned i = 0; i < count; ++i) threads.emplace_back([ended] { ended.wait(); });
  } catch (const std::system_error&) {
    all = false;
  }
  end.set_value();
  for (std::thread& thread : threads) thread.join();
  wait_until_gone(before);
  return all;
}

void require_threads(unsigned count, const std::string& user, const std::string& advice) {
  if (can_start_threads(count)) return;
  const std::string threads = count == 1 ? "a thread" : std::to_string(count) + " threads";
  throw DeviceError("cannot start " + threads + " for " + user + ": " + thread_limit_text() +
                    "; raise it, end other programs, or " + advice);
}

std::string thread_limit_text() {
  return "the system starts no more (Resource temporarily unavailable): the limit of processes and threads of "
         "this user (" +
         limit_text() + ") or of its container is reached";
}

}  // namespace kiloband
