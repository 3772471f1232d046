#include "cube/exr/exr_stream.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kBufferBytes = 1u << 16;  // headers come byte by byte

}  // namespace

ExrOutputStream::ExrOutputStream(AtomicFile& file) : OStream(file.name().c_str()), file_(file) {
  buffer_.reserve(kBufferBytes);
}

void ExrOutputStream::write(const char bytes[], int count) {
  // Header fields are collected; tiles are larger than the buffer and go straight to the file.
  const std::span<const char> data(bytes, static_cast<std::size_t>(count));
  if (in_head_) head_.append(bytes, data.size());
  if (buffer_.size() + data.size() > kBufferBytes) flush();
  if (data.size() <= kBufferBytes) {
    buffer_.insert(buffer_.end(), data.begin(), data.end());
    return;
  }
  try {
    file_.write_at(position_, data);
    position_ += data.size();
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
    throw;
  }
}

void ExrOutputStream::seekp(uint64_t position) {
  in_head_ = in_head_ && position == tellp();
  flush();
  position_ = position;
}

void ExrOutputStream::flush() {
  try {
    file_.write_at(position_, buffer_);
    position_ += buffer_.size();
    buffer_.clear();
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
    throw;
  }
}

void ExrOutputStream::rethrow_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

ExrInputStream::ExrInputStream(const InputFileBytes& file) : IStream(file.path().c_str()), file_(file) {}

bool ExrInputStream::read(char bytes[], int count) {
  const auto size = static_cast<std::size_t>(std::max(count, 0));
  if (position_ > file_.size() || size > file_.size() - position_)
    throw InputError("the file ends too early");
  if (size >= kBufferBytes) {
    read_file(position_, {bytes, size});
  } else {
    read_buffered(bytes, size);
  }
  position_ += size;
  return position_ < file_.size();
}

/// Small reads come from a window of the file; one outside it moves the window to the current position.
void ExrInputStream::read_buffered(char bytes[], std::size_t count) {
  const bool inside = position_ >= buffer_begin_ && position_ + count <= buffer_begin_ + buffer_.size();
  if (!inside) {
    buffer_.resize(std::min<uint64_t>(kBufferBytes, file_.size() - position_));
    buffer_begin_ = position_;
    read_file(position_, buffer_);
  }
  std::memcpy(bytes, buffer_.data() + (position_ - buffer_begin_), count);
}

/// Only failures of the machine are kept: OpenEXR would turn them into complaints about the file.
void ExrInputStream::read_file(uint64_t offset, std::span<char> out) {
  try {
    file_.read_at(offset, out);
  } catch (const DeviceError&) {
    buffer_.clear();
    if (!failure_) failure_ = std::current_exception();
    throw;
  }
}

void ExrInputStream::rethrow_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace kiloband
