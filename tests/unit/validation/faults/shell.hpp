// Runs a script and reads what it says.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

struct Said {
  int code = -1;     // exit code; -1 if a signal ended it
  std::string text;  // on both outputs
};

inline Said run_shell(const std::string& command) {
  const TemporaryFolder folder;
  const int status = std::system((command + " > '" + (folder / "said").string() + "' 2>&1").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, folder.read("said")};
}

}  // namespace kiloband::test
