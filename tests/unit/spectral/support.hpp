// Helpers of the spectral tests: temporary files, messages of errors, the real data folder.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "base/error.hpp"

namespace kiloband::test {

/// A folder of its own that goes away with the object.
class TempFolder {
 public:
  TempFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("kiloband_spectral_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::filesystem::remove(path_ / name);  // truncating a file makes some file systems wait for the disk
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What the InputError says that `action` throws, without the temporary folder's name; "" if it throws
/// nothing.
template <class Action>
std::string message_of(Action action, const std::string& folder = {}) {
  try {
    action();
  } catch (const InputError& error) {
    std::string text = error.what();
    for (std::size_t at; !folder.empty() && (at = text.find(folder + "/")) != std::string::npos;)
      text.erase(at, folder.size() + 1);
    return text;
  }
  return {};
}

/// Folder of public spectra that are not part of the project; empty where there is none.
inline std::optional<std::filesystem::path> real_spectra() {
  const char* given = std::getenv("KILOBAND_DATA");
  const std::filesystem::path folder =
      std::filesystem::path(given ? std::string(given) : std::string(KILOBAND_SOURCE_DIR "/../shared/data")) /
      "spectra";
  return std::filesystem::is_directory(folder) ? std::optional(folder) : std::nullopt;
}

}  // namespace kiloband::test
