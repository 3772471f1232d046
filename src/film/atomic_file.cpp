#include "film/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "base/error.hpp"

namespace kiloband {
namespace {

/// The file that a symbolic link leads to; the path itself if it is none or leads nowhere.
std::filesystem::path follow_link(const std::filesystem::path& target) {
  std::error_code error;
  if (!std::filesystem::is_symlink(target, error)) return target;
  const auto real = std::filesystem::canonical(target, error);
  return error ? target : real;
}

std::filesystem::path temporary_name(const std::filesystem::path& target) {
  static std::atomic<uint64_t> counter = 0;
  const std::string name =
      ".kiloband-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".partial";
  return target.parent_path() / name;
}

/// Makes the rename itself durable. Some file systems cannot do this; the data are safe by then, so failure
/// is no error.
void flush_folder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target) : target_(follow_link(target)) {
  std::error_code ignored;
  if (std::filesystem::is_directory(target_, ignored)) fail(EISDIR);
  do {  // a left-over of a killed process with our id is passed over
    temporary_ = temporary_name(target_);
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) fail(errno);
}

AtomicFile::~AtomicFile() {
  close_quietly();
}

void AtomicFile::close_quietly() noexcept {
  if (descriptor_ < 0) return;
  close(descriptor_);
  unlink(temporary_.c_str());
  descriptor_ = -1;
}

void AtomicFile::fail(int error) const {
  throw DeviceError("cannot write '" + target_.string() + "': " + std::strerror(error));
}

void AtomicFile::preallocate(uint64_t bytes) {
  const auto size = static_cast<off_t>(bytes);
  // fallocate instead of posix_fallocate, which would write zeros where the file system cannot reserve space.
  if (size > 0 && fallocate(descriptor_, 0, 0, size) != 0) {
    if (errno != EOPNOTSUPP && errno != ENOSYS) fail(errno);
  }
  if (ftruncate(descriptor_, size) != 0) fail(errno);
}

void AtomicFile::write_at(uint64_t offset, std::span<const char> bytes) {
  constexpr std::size_t kLargest = std::size_t{1} << 30;  // Linux writes at most 2 GiB at once
  while (!bytes.empty()) {
    const ssize_t written =
        pwrite(descriptor_, bytes.data(), std::min(bytes.size(), kLargest), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(written < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<uint64_t>(written);
    flushed_ = false;
  }
}

void AtomicFile::flush() {
  if (fsync(descriptor_) != 0) fail(errno);
  flushed_ = true;
}

void AtomicFile::commit() {
  if (!flushed_) flush();
  // Network file systems report late write errors here.
  const int closed = close(descriptor_);
  const int close_error = errno;
  descriptor_ = -1;
  if (closed != 0 || rename(temporary_.c_str(), target_.c_str()) != 0) {
    const int error = closed != 0 ? close_error : errno;
    unlink(temporary_.c_str());
    fail(error);
  }
  flush_folder(target_.parent_path());
}

void write_file_atomically(const std::filesystem::path& target, std::span<const char> bytes) {
  AtomicFile file(target);
  file.write_at(0, bytes);
  file.commit();
}

}  // namespace kiloband
