// What the tests of this folder share: a temporary folder, the text of an InputError,
// collected diagnostics, real data.
#pragma once

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

/// The message of the InputError that `action` throws, "no error" if it returns.
inline std::string error_of(const TemporaryFolder& folder, const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return folder.strip(error.what());
  }
  return "no error";
}

/// Keeps the diagnostics that a reader reports.
struct Collector {
  std::vector<std::string> texts;
  DiagnosticSink sink(const TemporaryFolder& folder) {
    return [this, &folder](const Diagnostic& d) { texts.push_back(folder.strip(d.to_string())); };
  }
};

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

/// The folder of real data files, if this machine has one.
inline std::optional<std::filesystem::path> data_folder() {
  const char* set = std::getenv("KILOBAND_DATA");
  const std::filesystem::path folder =
      set ? std::filesystem::path(set) : std::filesystem::path(KILOBAND_SOURCE_DIR) / "../shared/data";
  if (std::filesystem::is_directory(folder)) return folder;
  return std::nullopt;
}

}  // namespace kiloband::test
