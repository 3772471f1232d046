// Bytes of a checkpoint, from a file or from memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace kiloband {

class CheckpointSource {
 public:
  virtual ~CheckpointSource() = default;
  virtual uint64_t size() const = 0;  // bytes in all
  /// The next bytes; false: there are not as many, or they cannot be read.
  virtual bool read(std::span<char> to) = 0;
};

/// Opens without waiting.
/// throws InputError  "checkpoint FILE ...": missing, no regular file
std::unique_ptr<CheckpointSource> open_checkpoint(const std::filesystem::path& file);
/// The bytes must outlive the source.
std::unique_ptr<CheckpointSource> checkpoint_in_memory(std::span<const char> bytes);

/// "is a folder", "is a named pipe" ...; empty: a regular file. mode: st_mode of stat()
std::string irregular_kind(unsigned mode);

}  // namespace kiloband
