// Streams that let OpenEXR write into an AtomicFile and read with size checks, without losing our errors:
// OpenEXR's destructors and tasks swallow or rename exceptions, so the first one is kept and thrown again.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <exception>
#include <string>
#include <vector>

#include "files/atomic_file.hpp"
#include "files/input_file.hpp"

namespace kiloband {

class ExrOutputStream : public Imf::OStream {
 public:
  explicit ExrOutputStream(AtomicFile& file);

  void write(const char bytes[], int count) override;
  uint64_t tellp() override { return position_ + buffer_.size(); }
  void seekp(uint64_t position) override;
  /// The first bytes of the file, as they came: up to where something was written elsewhere or head_ends() was called.
  void head_ends() { in_head_ = false; }
  const std::string& head() const { return head_; }
  /// Empties the buffer into the file.
  void flush();
  /// Throws the first failure again, if there was one.
  void rethrow_failure() const;

 private:
  AtomicFile& file_;
  std::vector<char> buffer_;  // bytes from position_ on that are not in the file yet
  std::string head_;
  bool in_head_ = true;
  uint64_t position_ = 0;
  std::exception_ptr failure_;
};

class ExrInputStream : public Imf::IStream {
 public:
  explicit ExrInputStream(const InputFileBytes& file);

  bool read(char bytes[], int count) override;
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }
  /// Throws again what the machine did wrong (DeviceError); a file that ends too early is left to the caller.
  void rethrow_failure() const;

 private:
  void read_buffered(char bytes[], std::size_t count);
  void read_file(uint64_t offset, std::span<char> out);

  const InputFileBytes& file_;
  std::vector<char> buffer_;  // bytes of the file from buffer_begin_ on
  uint64_t buffer_begin_ = 0, position_ = 0;
  std::exception_ptr failure_;
};

}  // namespace kiloband
