// A file for libraries in C, closed when it is let go.
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>

namespace kiloband {

class CFile {
 public:
  explicit CFile(const std::string& file) : stream_(std::fopen(file.c_str(), "rb")) {
    if (!stream_) throw std::runtime_error("cannot be opened");
  }
  ~CFile() { std::fclose(stream_); }
  CFile(const CFile&) = delete;
  CFile& operator=(const CFile&) = delete;

  std::FILE* stream() const { return stream_; }

 private:
  std::FILE* stream_;
};

}  // namespace kiloband
