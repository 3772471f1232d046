#include "files/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.hpp"

namespace kiloband {

InputFileBytes::InputFileBytes(const std::filesystem::path& file) : path_(file) {
  // Non-blocking, so that a named pipe does not hang; regular files do not care.
  descriptor_ = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status = {};
  if (descriptor_ < 0 || fstat(descriptor_, &status) != 0) {
    const int error = errno;
    if (descriptor_ >= 0) close(descriptor_);
    throw InputError("cannot open '" + file.string() + "': " + std::strerror(error));
  }
  if (!S_ISREG(status.st_mode)) {
    close(descriptor_);
    throw InputError("cannot open '" + file.string() + "': not a regular file");
  }
  size_ = static_cast<uint64_t>(status.st_size);
}

InputFileBytes::~InputFileBytes() {
  close(descriptor_);
}

void InputFileBytes::read_at(uint64_t offset, std::span<char> out) const {
  constexpr std::size_t kLargest = std::size_t{1} << 30;  // Linux reads at most 2 GiB at once
  while (!out.empty()) {
    const ssize_t got =
        pread(descriptor_, out.data(), std::min(out.size(), kLargest), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw DeviceError("cannot read '" + path_.string() + "': " + std::strerror(errno));
    // The size was checked before, so the file shrank while it was read.
    if (got == 0) throw InputError(path_.string() + ": the file ends too early");
    out = out.subspan(static_cast<std::size_t>(got));
    offset += static_cast<uint64_t>(got);
  }
}

std::string read_small_file(const std::filesystem::path& file, uint64_t max_bytes) {
  const InputFileBytes bytes(file);
  if (bytes.size() > max_bytes)
    throw InputError(file.string() + ": " + std::to_string(bytes.size()) + " bytes: at most " +
                     std::to_string(max_bytes) + " are allowed here");
  std::string text(bytes.size(), '\0');
  bytes.read_at(0, text);
  return text;
}

}  // namespace kiloband
