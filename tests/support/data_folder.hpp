// Public scenes, meshes and spectra, which are not part of the project.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace kiloband::test {

/// A part of KILOBAND_DATA, or of shared/data beside the checkout; empty where there is none.
inline std::filesystem::path data_folder(const std::string& part = "") {
  const char* named = std::getenv("KILOBAND_DATA");
  const std::filesystem::path folder =
      (named ? std::filesystem::path(named) : std::filesystem::path(KILOBAND_SOURCE_DIR) / "../shared/data") /
      part;
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

}  // namespace kiloband::test
