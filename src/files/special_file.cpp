#include "files/special_file.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>
#include <vector>

namespace kiloband {
namespace {

constexpr std::size_t kBufferBytes = 1u << 20;

/// Holds back SIGPIPE in this thread, and takes away the one that came meanwhile.
class WithoutSigpipe {
 public:
  WithoutSigpipe() {
    sigset_t pending;
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutSigpipe() {
    const timespec now{};
    while (!was_pending_ && sigtimedwait(&pipe_, nullptr, &now) < 0 && errno == EINTR) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  WithoutSigpipe(const WithoutSigpipe&) = delete;
  WithoutSigpipe& operator=(const WithoutSigpipe&) = delete;

 private:
  sigset_t pipe_, before_;
  bool was_pending_;
};

int open_special_file(const OutputTarget& to) {
  if (to.descriptor >= 0) return fcntl(to.descriptor, F_DUPFD_CLOEXEC, 3);
  int descriptor = -1;
  do {
    descriptor = open(to.file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  } while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

/// Returns 0 or errno's value.
int write_all(int descriptor, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = write(descriptor, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : ENOSPC;
    data += written;
    size -= static_cast<std::size_t>(written);
  }
  return 0;
}

int copy(int from, int to) {
  std::vector<char> buffer(kBufferBytes);
  for (off_t offset = 0;;) {
    const ssize_t size = pread(from, buffer.data(), buffer.size(), offset);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return size < 0 ? errno : 0;
    if (const int error = write_all(to, buffer.data(), static_cast<std::size_t>(size)); error != 0)
      return error;
    offset += size;
  }
}

}  // namespace

int copy_to_special_file(int from, const OutputTarget& to) {
  const int descriptor = open_special_file(to);
  if (descriptor < 0) return errno;
  int error = 0;
  {
    const WithoutSigpipe held_back;
    error = copy(from, descriptor);
  }
  if (close(descriptor) != 0 && error == 0) error = errno;
  return error;
}

}  // namespace kiloband
