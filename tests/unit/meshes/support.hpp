// What the tests of this folder share: a temporary folder, the text of an InputError, collected diagnostics,
// real data.
#pragma once

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"

namespace kiloband::test {

/// A folder of its own, removed at the end.
class TempFolder {
 public:
  TempFolder() {
    static std::atomic<int> counter{0};
    path_ = std::filesystem::temp_directory_path() /
            ("kiloband_meshes_" + std::to_string(::getpid()) + "_" + std::to_string(counter++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path path(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    // Some file systems flush a file that is truncated and written again; a new one costs nothing.
    std::filesystem::remove(path(name));
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }
  /// The text without this folder in front of file names.
  std::string strip(std::string text) const {
    const std::string prefix = path_.string() + "/";
    for (size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text;
  }

 private:
  std::filesystem::path path_;
};

/// The message of the InputError that `action` throws, "no error" if it returns.
inline std::string error_of(const TempFolder& folder, const std::function<void()>& action) {
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
  DiagnosticSink sink(const TempFolder& folder) {
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
