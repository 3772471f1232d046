// Pipes and devices in test folders.
#pragma once

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

namespace kiloband::test {

inline void make_pipe(const std::filesystem::path& file) {
  if (mkfifo(file.c_str(), 0666) != 0) throw std::runtime_error("mkfifo failed");
}

/// /dev/full under another name: a device of its own where we may make one, so that a fault under test cannot
/// replace the machine's, otherwise a link to it, which we could not replace either.
inline void make_full_device(const std::filesystem::path& file) {
  if (mknod(file.c_str(), S_IFCHR | 0666, makedev(1, 7)) == 0) {
    if (access(file.c_str(), W_OK) == 0 && chmod(file.c_str(), 0666) == 0) return;
    std::filesystem::remove(file);
  }
  std::filesystem::create_symlink("/dev/full", file);
}

}  // namespace kiloband::test
