#include "app/console/stop_signals.hpp"

#include <csignal>
#include <initializer_list>

#include "files/temporary_file.hpp"

namespace kiloband {

std::atomic<bool> stop_requested{false};

namespace {

/// Async-signal-safe. The signal is blocked in its handler: it ends the process when the handler returns.
void end_at_once(int signal) {
  remove_temporary_files();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void request_stop(int signal) {
  if (stop_requested.exchange(true)) end_at_once(signal);
}

void handle(std::initializer_list<int> signals, void (*handler)(int)) {
  struct sigaction action = {}, before = {};
  action.sa_handler = handler;
  for (const int signal : signals) {
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

}  // namespace

void catch_ending_signals() {
  handle({SIGHUP, SIGINT, SIGTERM}, end_at_once);
}

void catch_stop_signals() {
  handle({SIGINT, SIGTERM}, request_stop);
}

}  // namespace kiloband
