#include "files/output_target.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "base/number.hpp"

namespace kiloband {
namespace {

constexpr int kMostLinks = 40;  // Linux's own limit

/// N if the path is entry N of this process's table of open files.
std::optional<int> own_descriptor(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const std::optional<int> number = whole_number<int>(name);
  if (!number || *number < 0) return std::nullopt;
  std::error_code error;
  const bool ours = std::filesystem::equivalent(path.parent_path(), "/proc/self/fd", error);
  return ours && !error ? number : std::nullopt;
}

OutputTarget descriptor_target(const std::filesystem::path& path, int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  const bool writable = flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
  return {path, descriptor, true, writable ? 0 : EBADF};
}

OutputTarget existing_target(const std::filesystem::path& path, mode_t mode) {
  if (S_ISDIR(mode)) return {.file = path, .error = EISDIR};
  if (S_ISREG(mode)) return {.file = path};
  // Opening may wait for a reader (a pipe) or do something (a device): that is left to the writer.
  const bool writable = faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0;
  return {.file = path, .special = true, .error = writable ? 0 : errno};
}

}  // namespace

OutputTarget find_output_target(const std::filesystem::path& name) {
  std::filesystem::path path = name;
  for (int links = 0; links <= kMostLinks; ++links) {
    if (const auto descriptor = own_descriptor(path)) return descriptor_target(path, *descriptor);
    struct stat status = {};
    if (lstat(path.c_str(), &status) != 0) return {.file = path, .error = errno == ENOENT ? 0 : errno};
    if (!S_ISLNK(status.st_mode)) return existing_target(path, status.st_mode);
    std::error_code error;
    const auto next = std::filesystem::read_symlink(path, error);
    if (error) return {.file = path, .error = error.value()};
    path = path.parent_path() / next;  // an absolute `next` stands for itself
  }
  return {.file = name, .error = ELOOP};
}

std::optional<std::string> output_identity(const std::filesystem::path& name) {
  const OutputTarget target = find_output_target(name);
  if (target.special) return std::nullopt;
  struct stat status = {};
  if (stat(target.file.c_str(), &status) == 0)
    return "inode " + std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
  std::error_code error;
  const auto absolute = std::filesystem::absolute(target.file, error);
  const auto real = std::filesystem::weakly_canonical(absolute, error);
  return (error ? target.file : real).string();
}

std::error_code remove_output(const std::filesystem::path& name) {
  const OutputTarget target = find_output_target(name);
  std::error_code error(target.error, std::generic_category());
  if (!error && !target.special) std::filesystem::remove(target.file, error);
  return error;
}

}  // namespace kiloband
