// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace kiloband {

/// Writes to a temporary name in the target's folder (".kiloband-<process>-<number>.partial"); commit()
/// flushes it to the device and renames it. Destroyed without commit (also by an exception), it is removed
/// and the target is untouched. A target that is a symbolic link is followed, so that the link stays. Every
/// failure is a DeviceError "cannot write 'FILE': <the system's message>".
class AtomicFile {
 public:
  /// throws DeviceError  folder missing or read-only, target is a folder ...
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Claims `bytes` of disk, so that a full disk shows now and not after hours; the file has that size
  /// afterwards.
  void preallocate(uint64_t bytes);
  void write_at(uint64_t offset, std::span<const char> bytes);
  /// Flushes to the device; commit() does this if it was not done.
  void flush();
  void commit();

  const std::filesystem::path& target() const { return target_; }

 private:
  [[noreturn]] void fail(int error) const;
  void close_quietly() noexcept;

  std::filesystem::path target_, temporary_;
  int descriptor_ = -1;
  bool flushed_ = false;
};

/// Writes a small file at once, atomically.
void write_file_atomically(const std::filesystem::path& target, std::span<const char> bytes);

}  // namespace kiloband
