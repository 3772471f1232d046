#include "render/checkpoint/checkpoint_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.hpp"

namespace kiloband {

constexpr std::size_t kReadBytes = std::size_t{1} << 20;

std::string irregular_kind(unsigned mode) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return "is a folder";
  if (S_ISFIFO(mode)) return "is a named pipe";
  if (S_ISSOCK(mode)) return "is a socket";
  return "is a device";
}

CheckpointSource::CheckpointSource(const std::filesystem::path& file)
    // Without O_NONBLOCK a named pipe would wait for its writer.
    : descriptor_(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  const std::string name = "checkpoint " + file.string() + " ";
  if (descriptor_ < 0) throw InputError(name + "cannot be opened: " + std::strerror(errno));
  struct stat status {};
  const bool known = fstat(descriptor_, &status) == 0;
  if (const std::string kind = known ? irregular_kind(status.st_mode) : "cannot be read"; !kind.empty()) {
    close(descriptor_);
    throw InputError(name + kind + ": must be a regular file");
  }
  size_ = static_cast<uint64_t>(status.st_size);
}

CheckpointSource::~CheckpointSource() {
  close(descriptor_);
}

bool CheckpointSource::read(std::span<char> to) {
  while (!to.empty()) {
    if (next_ == end_ && !fill()) return false;
    const std::size_t some = std::min(to.size(), end_ - next_);
    std::memcpy(to.data(), &buffer_[next_], some);
    next_ += some;
    to = to.subspan(some);
  }
  return true;
}

bool CheckpointSource::fill() {
  buffer_.resize(kReadBytes);
  ssize_t got = 0;
  do got = ::read(descriptor_, buffer_.data(), buffer_.size());
  while (got < 0 && errno == EINTR);
  next_ = 0;
  end_ = got > 0 ? static_cast<std::size_t>(got) : 0;
  return got > 0;
}

}  // namespace kiloband
