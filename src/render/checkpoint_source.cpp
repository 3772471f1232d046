#include "render/checkpoint_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "base/error.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

class FileSource final : public CheckpointSource {
 public:
  FileSource(int descriptor, uint64_t size) : descriptor_(descriptor), size_(size) {}
  ~FileSource() override { close(descriptor_); }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  uint64_t size() const override { return size_; }

  bool read(std::span<char> to) override {
    while (!to.empty()) {
      if (next_ == end_ && !fill()) return false;
      const std::size_t some = std::min(to.size(), end_ - next_);
      std::memcpy(to.data(), &buffer_[next_], some);
      next_ += some;
      to = to.subspan(some);
    }
    return true;
  }

 private:
  bool fill() {
    buffer_.resize(kBufferBytes);
    ssize_t got = 0;
    do got = ::read(descriptor_, buffer_.data(), buffer_.size());
    while (got < 0 && errno == EINTR);
    next_ = 0;
    end_ = got > 0 ? static_cast<std::size_t>(got) : 0;
    return got > 0;
  }

  int descriptor_;
  uint64_t size_;
  std::vector<char> buffer_;
  std::size_t next_ = 0, end_ = 0;
};

class MemorySource final : public CheckpointSource {
 public:
  explicit MemorySource(std::span<const char> bytes) : bytes_(bytes), size_(bytes.size()) {}
  uint64_t size() const override { return size_; }
  bool read(std::span<char> to) override {
    if (to.size() > bytes_.size()) return false;
    std::ranges::copy(bytes_.first(to.size()), to.begin());
    bytes_ = bytes_.subspan(to.size());
    return true;
  }

 private:
  std::span<const char> bytes_;
  uint64_t size_;
};

}  // namespace

std::string irregular_kind(unsigned mode) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return "is a folder";
  if (S_ISFIFO(mode)) return "is a named pipe";
  if (S_ISSOCK(mode)) return "is a socket";
  return "is a device";
}

std::unique_ptr<CheckpointSource> open_checkpoint(const std::filesystem::path& file) {
  const std::string name = "checkpoint " + file.string() + " ";
  // Without O_NONBLOCK a named pipe would wait for its writer.
  const int descriptor = open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) throw InputError(name + "cannot be opened: " + std::strerror(errno));
  struct stat status {};
  const bool known = fstat(descriptor, &status) == 0;
  if (const std::string kind = known ? irregular_kind(status.st_mode) : "cannot be read"; !kind.empty()) {
    close(descriptor);
    throw InputError(name + kind + ": must be a regular file");
  }
  return std::make_unique<FileSource>(descriptor, static_cast<uint64_t>(status.st_size));
}

std::unique_ptr<CheckpointSource> checkpoint_in_memory(std::span<const char> bytes) {
  return std::make_unique<MemorySource>(bytes);
}

}  // namespace kiloband
