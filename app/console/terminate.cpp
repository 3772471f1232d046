// What the user is told when the system refuses a library its threads where no exception can be caught.
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <exception>
#include <string>
#include <system_error>

#include "app/commands.hpp"
#include "base/threads.hpp"

namespace kiloband {
namespace {

bool is_refusal(const std::exception_ptr& failure) {
  if (!failure) return false;
  try {
    std::rethrow_exception(failure);
  } catch (const std::system_error& error) {
    return error.code() == std::errc::resource_unavailable_try_again;
  } catch (...) {
    return false;
  }
}

[[noreturn]] void explain() {
  if (!is_refusal(std::current_exception())) std::abort();
  const std::string text = "kiloband: cannot start a thread: " + thread_limit_text() + "\n";
  // Not through a stream: what has one buffered may not be set up yet, or torn down.
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
  _exit(kMachineFailed);
}

void set_up() {
  std::set_terminate(explain);
}

/// Called before the libraries are initialised: some that read images start threads there.
[[gnu::section(".preinit_array"), gnu::used]] void (*set_up_first)() = set_up;

}  // namespace
}  // namespace kiloband
