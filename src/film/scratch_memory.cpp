#include "film/scratch_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "base/error.hpp"

namespace kiloband {
namespace {

[[noreturn]] void fail(const std::string& what, int error) {
  throw DeviceError("scratch memory: " + what + ": " + std::strerror(error));
}

/// An unnamed file of `bytes` bytes with its disk space claimed.
int create_scratch_file(std::size_t bytes) {
  const std::string folder = std::filesystem::temp_directory_path().string();
  const int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor < 0) fail("cannot create a file in '" + folder + "'", errno);
  if (const int error = posix_fallocate(descriptor, 0, static_cast<off_t>(bytes)); error != 0) {
    close(descriptor);
    fail("no space for " + std::to_string(bytes >> 20) + " MiB in '" + folder + "'", error);
  }
  return descriptor;
}

}  // namespace

ScratchFloats::ScratchFloats(std::size_t count, std::size_t budget_bytes) : count_(count) {
  const bool in_file = count * sizeof(float) > budget_bytes;
  const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(float);
  const int descriptor = in_file ? create_scratch_file(bytes) : -1;
  const int flags = in_file ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS;
  void* address = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, flags, descriptor, 0);
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (address == MAP_FAILED) fail("cannot map " + std::to_string(bytes >> 20) + " MiB", error);
  data_ = static_cast<float*>(address);
}

ScratchFloats::~ScratchFloats() {
  munmap(data_, std::max<std::size_t>(count_, 1) * sizeof(float));
}

}  // namespace kiloband
