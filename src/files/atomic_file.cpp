#include "files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "base/error.hpp"
#include "files/special_file.hpp"

namespace kiloband {

AtomicFile::AtomicFile(const std::filesystem::path& name, mode_t mode)
    : name_(name), target_(find_output_target(name)) {
  if (target_.error != 0) fail(target_.error);
  const int error = target_.special ? file_.create_scratch() : file_.create(target_.file.parent_path(), mode);
  if (error != 0) fail_before(error);
}

void AtomicFile::fail(int error) const {
  throw DeviceError("cannot write '" + name_.string() + "': " + std::strerror(error));
}

void AtomicFile::fail_before(int error) const {
  if (!target_.special) fail(error);
  throw DeviceError("cannot write '" + name_.string() + "': scratch file in '" + file_.folder().string() +
                    "': " + std::strerror(error));
}

void AtomicFile::preallocate(uint64_t bytes) {
  const auto size = static_cast<off_t>(bytes);
  // fallocate instead of posix_fallocate, which would write zeros where the file system cannot reserve space.
  if (size > 0 && fallocate(file_.descriptor(), 0, 0, size) != 0) {
    if (errno != EOPNOTSUPP && errno != ENOSYS) fail_before(errno);
  }
  if (ftruncate(file_.descriptor(), size) != 0) fail_before(errno);
}

void AtomicFile::write_at(uint64_t offset, std::span<const char> bytes) {
  constexpr std::size_t kLargest = std::size_t{1} << 30;  // Linux writes at most 2 GiB at once
  while (!bytes.empty()) {
    const ssize_t written = pwrite(file_.descriptor(), bytes.data(), std::min(bytes.size(), kLargest),
                                   static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail_before(written < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<uint64_t>(written);
    flushed_ = false;
  }
}

void AtomicFile::flush() {
  if (!flushed_ && !target_.special && fsync(file_.descriptor()) != 0) fail_before(errno);
  flushed_ = true;
}

void AtomicFile::publish() {
  flush();
  struct stat status = {};
  if (fstat(file_.descriptor(), &status) != 0) fail(errno);
  device_ = status.st_dev;
  inode_ = status.st_ino;
  const int error =
      target_.special ? copy_to_special_file(file_.descriptor(), target_) : file_.publish(target_.file);
  if (error != 0) fail(error);
}

void AtomicFile::commit() {
  publish();
  if (!target_.special) flush_folder(target_.file.parent_path());
}

bool AtomicFile::stands() const {
  struct stat status = {};
  if (target_.special) return true;
  return stat(target_.file.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_;
}

void write_file_atomically(const std::filesystem::path& name, std::span<const char> bytes, mode_t mode) {
  AtomicFile file(name, mode);
  file.write_at(0, bytes);
  file.commit();
}

void check_writable(const std::filesystem::path& name) {
  const AtomicFile trial(name);  // vanishes at once
}

void flush_folder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace kiloband
