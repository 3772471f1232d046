// A file that is read from its start, byte by byte or in blocks: what the readers of Radiance and PFM files share.
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>

namespace kiloband {

class ByteFile {
 public:
  explicit ByteFile(const std::string& file) : stream_(file, std::ios::binary) {
    if (!stream_) throw std::runtime_error("cannot be opened");
  }

  /// False: the file ends before.
  bool read(void* target, std::size_t bytes) {
    const auto wanted = static_cast<std::streamsize>(bytes);
    return stream_.rdbuf()->sgetn(static_cast<char*>(target), wanted) == wanted;
  }
  /// -1 at the end.
  int byte() { return stream_.rdbuf()->sbumpc(); }

  /// Without its end; at most `longest` bytes.
  std::string line(std::size_t longest = 4096) {
    std::string text;
    for (int c = byte(); c != '\n'; c = byte()) {
      if (c < 0) throw std::runtime_error("the header ends too early");
      if (text.size() == longest) throw std::runtime_error("a line of the header is too long");
      text += static_cast<char>(c);
    }
    return text;
  }

  std::streamoff position() { return stream_.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in); }
  void seek(std::streamoff to) { stream_.rdbuf()->pubseekpos(to, std::ios::in); }

 private:
  std::ifstream stream_;
};

}  // namespace kiloband
