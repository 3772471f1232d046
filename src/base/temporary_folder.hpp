// Folders for scratch files.
#pragma once

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
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

/// Such a folder, removed with its contents at the end.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& prefix = "kiloband") : path_(make_temporary_folder(prefix)) {}
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// Writes a file, in folders that are made if need be, and returns its path. An older file is removed first:
  /// truncating one in place makes some file systems wait for the disk.
  std::filesystem::path write(const std::string& name, const std::string& contents) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::filesystem::remove(file);
    std::ofstream(file, std::ios::binary) << contents;
    return file;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace kiloband
