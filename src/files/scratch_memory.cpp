#include "files/scratch_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "base/error.hpp"
#include "files/temporary_file.hpp"

namespace kiloband {
namespace {

[[noreturn]] void fail(const std::string& what, int error) {
  throw DeviceError("scratch memory: " + what + ": " + std::strerror(error));
}

/// Claims the file's disk space.
void create_scratch_file(TemporaryFile& file, std::size_t bytes) {
  if (const int error = file.create_scratch(); error != 0)
    fail("cannot create a file in '" + file.folder().string() + "'", error);
  if (const int error = posix_fallocate(file.descriptor(), 0, static_cast<off_t>(bytes)); error != 0)
    fail("no space for " + std::to_string(bytes >> 20) + " MiB in '" + file.folder().string() + "'", error);
}

}  // namespace

ScratchFloats::ScratchFloats(std::size_t count, std::size_t budget_bytes) : count_(count) {
  const bool in_file = count * sizeof(float) > budget_bytes;
  const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(float);
  TemporaryFile file;
  if (in_file) create_scratch_file(file, bytes);
  const int flags = in_file ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS;
  void* address = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, flags, file.descriptor(), 0);
  if (address == MAP_FAILED) fail("cannot map " + std::to_string(bytes >> 20) + " MiB", errno);
  data_ = static_cast<float*>(address);
}

ScratchFloats::~ScratchFloats() {
  munmap(data_, std::max<std::size_t>(count_, 1) * sizeof(float));
}

}  // namespace kiloband
