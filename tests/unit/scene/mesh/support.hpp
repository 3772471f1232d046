// What the tests of this folder share.
#pragma once

#include <ctime>
#include <filesystem>
#include <string>

#include "tests/support/messages.hpp"

namespace kiloband::test {

/// A broken file and what must be said about it.
struct BrokenFile {
  const char* what;
  std::string content;
  std::string message;
};

/// Processor time, which other programs on the machine do not stretch.
inline double cpu_seconds_since(std::clock_t start) {
  return double(std::clock() - start) / CLOCKS_PER_SEC;
}

}  // namespace kiloband::test
