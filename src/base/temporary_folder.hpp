// Folders for scratch files.
#pragma once

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace kiloband {

/// Makes a new folder in the system's temporary folder (TMPDIR), "PREFIX_" and six characters that nobody can
/// guess, for this user alone: others could lay files or links in wait under a name that is known beforehand.
/// throws std::system_error
inline std::filesystem::path make_temporary_folder(const std::string& prefix) {
  std::string path = (std::filesystem::temp_directory_path() / (prefix + "_" + std::string(6, 'X'))).string();
  if (!mkdtemp(path.data())) throw std::system_error(errno, std::generic_category(), path);
  return path;
}

}  // namespace kiloband
