// A checkpoint's bytes, one after the other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kiloband {

class CheckpointSource {
 public:
  /// Opens without waiting.
  /// throws InputError  "checkpoint FILE ...": missing, no regular file
  explicit CheckpointSource(const std::filesystem::path& file);
  ~CheckpointSource();
  CheckpointSource(const CheckpointSource&) = delete;
  CheckpointSource& operator=(const CheckpointSource&) = delete;

  uint64_t size() const { return size_; }  // bytes in all
  /// The next bytes; false: there are not as many, or they cannot be read.
  bool read(std::span<char> to);

 private:
  bool fill();

  int descriptor_;
  uint64_t size_ = 0;
  std::vector<char> buffer_;
  std::size_t next_ = 0, end_ = 0;
};

/// "is a folder", "is a named pipe" ...; empty: a regular file. mode: st_mode of stat()
std::string irregular_kind(unsigned mode);

}  // namespace kiloband
