// Helpers of the spectral tests: temporary files, messages of errors, the real data folder.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

/// What the InputError says that `action` throws, without the temporary folder's name;
/// "" if it throws nothing.
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
