// A file that is read at offsets, with its size known before anything is allocated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace kiloband {

class InputFileBytes {
 public:
  /// throws InputError  "cannot open 'FILE': <the system's message>", or not a regular file
  explicit InputFileBytes(const std::filesystem::path& file);
  ~InputFileBytes();
  InputFileBytes(const InputFileBytes&) = delete;
  InputFileBytes& operator=(const InputFileBytes&) = delete;

  uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }
  /// Fills `out` from `offset`.
  /// throws InputError  beyond the end; DeviceError  the disk fails
  void read_at(uint64_t offset, std::span<char> out) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

/// The whole of a small text file; InputError if it has more than max_bytes.
std::string read_small_file(const std::filesystem::path& file, uint64_t max_bytes);

}  // namespace kiloband
