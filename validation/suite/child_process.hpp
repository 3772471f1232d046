// Another program, run with its output caught.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "validation/suite/rendering.hpp"

namespace kiloband::validation {

struct ChildEnd {
  int code = -1;         // exit code; -1: it could not be started, or a signal ended it
  int signal = 0;        // that ended it
  bool stopped = false;  // by the watch
  std::string out, err;  // all that it printed; why it could not be started

  /// "exit code 2: the last line that it printed", "ended by signal 11".
  std::string description() const;
};

/// command: the program (looked for in PATH where it has no slash) and its arguments, passed on as they are.
/// The child starts in "/", so files must be named by absolute paths: an interpreter takes modules from the
/// current folder (`python3 -c`, an empty entry of PYTHONPATH), matplotlib its matplotlibrc, PATH may name it,
/// and there may be anything in it.
/// heard: called with every complete line of its standard output; may be empty.
/// The child is the head of a process group of its own; once the watch says stop, the group is sent SIGTERM
/// and, if the child is still there kStopSeconds later, SIGKILL.
ChildEnd run_child(const std::vector<std::string>& command, const Watch& watch,
                   const std::function<void(const std::string& line)>& heard);

inline constexpr double kStopSeconds = 10;

}  // namespace kiloband::validation
