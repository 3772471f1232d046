// A file that appears whole or not at all.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "files/output_target.hpp"
#include "files/temporary_file.hpp"

namespace kiloband {

/// Writes to a file without a name (TemporaryFile) in the target's folder; commit() flushes it to the device
/// and gives it the target's name. Destroyed without commit (also by an exception), it is gone and the target
/// is untouched. Symbolic links are followed to their end, so that they stay; of a file that has several
/// names (hard links) the one that is given is replaced. What is no regular file, a pipe, a device,
/// /dev/stdout, is never replaced: the data are collected in the temporary folder (TMPDIR), so that formats
/// that go back and forth can be written, and commit() writes them there from beginning to end; a named pipe
/// waits for its reader. Every failure is a DeviceError "cannot write 'FILE': <the system's message>", FILE
/// as it was given.
class AtomicFile {
 public:
  /// mode: permissions of a new file, of which the umask takes its own
  /// throws DeviceError  folder missing or read-only, target is a folder ...
  explicit AtomicFile(const std::filesystem::path& name, mode_t mode = 0666);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Claims `bytes` of disk, so that a full disk shows now and not after hours;
  /// the file has that size afterwards.
  void preallocate(uint64_t bytes);
  void write_at(uint64_t offset, std::span<const char> bytes);
  /// Flushes to the device; commit() does this if it was not done.
  void flush();
  void commit();

  /// For sets of files (FileSet): commit() without waiting for the folder's entry to reach the device.
  void publish();
  /// After publish(): whether the target still is this file. Special files are not asked.
  bool stands() const;

  /// As it was given.
  const std::filesystem::path& name() const { return name_; }
  const OutputTarget& target() const { return target_; }

 private:
  [[noreturn]] void fail(int error) const;
  /// Of the file that is not yet the target.
  [[noreturn]] void fail_before(int error) const;

  std::filesystem::path name_;
  OutputTarget target_;
  TemporaryFile file_;
  bool flushed_ = false;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

/// Writes a small file at once, atomically.
void write_file_atomically(const std::filesystem::path& name, std::span<const char> bytes,
                           mode_t mode = 0666);

/// Tries whether a file of this name could be written, and leaves everything as it is.
/// throws DeviceError
void check_writable(const std::filesystem::path& name);

/// Makes names that were given in a folder durable. Some file systems cannot do this; the data are safe by
/// then, so failure is no error.
void flush_folder(const std::filesystem::path& folder);

}  // namespace kiloband
