// Ctrl-C and its like.
#pragma once

#include <atomic>

namespace kiloband {

/// Set by SIGINT and SIGTERM after catch_stop_signals().
extern std::atomic<bool> stop_requested;

/// For the start of the program: SIGHUP, SIGINT and SIGTERM end it at once, as they do anyway, but not
/// without removing its temporary files. Signals that the caller ignores (nohup, scripts) stay ignored.
void catch_ending_signals();

/// To be called when there begins to be something to save: the first SIGINT or SIGTERM asks to stop, the
/// second ends the program at once again.
void catch_stop_signals();

}  // namespace kiloband
