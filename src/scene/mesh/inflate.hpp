// A zlib stream inside a file, decompressed piece by piece.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "scene/mesh/input.hpp"

namespace kiloband {

/// Every read either delivers all bytes asked for or throws InputError with the byte of the file
/// where it got stuck.
class InflateStream {
 public:
  /// Reads from file.bytes[begin, end); `file` must outlive the stream.
  InflateStream(const MeshFile& file, size_t begin, size_t end);
  ~InflateStream();
  InflateStream(const InflateStream&) = delete;
  InflateStream& operator=(const InflateStream&) = delete;

  void read(void* target, size_t bytes);
  /// throws InputError  unless the stream ends here with the right checksum
  void expect_end();
  /// Position in the file, for messages.
  size_t offset() const;
  /// More bytes than what is left of the stream could ever expand to.
  size_t limit() const;

 private:
  struct State;
  const MeshFile& file_;
  std::unique_ptr<State> state_;
};

}  // namespace kiloband
