#include "app/console/standard_output.hpp"

#include <fcntl.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"

namespace kiloband {
namespace {

int first_error = 0;  // errno's value where printing failed

}  // namespace

void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number is this one; the others below it are taken.
    const int opened = open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (opened >= 0 && opened != stream) close(opened);
  }
}

void answer_text(const std::string& text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() && first_error == 0)
    first_error = errno;
}

void finish_standard_output() {
  errno = 0;
  const bool used = __fpending(stdout) > 0 || std::ferror(stdout) != 0;
  if (std::fflush(stdout) != 0 && first_error == 0) first_error = errno;
  if (std::ferror(stdout) != 0 && first_error == 0)
    first_error = EIO;  // not printed by us: the reason is gone
  // Network file systems report late write errors when a descriptor is closed; a copy of it does.
  if (const int copy = dup(STDOUT_FILENO); copy >= 0 && close(copy) != 0 && used && first_error == 0)
    first_error = errno;
  if (first_error != 0)
    throw DeviceError(std::string("cannot write to standard output: ") + std::strerror(first_error));
}

}  // namespace kiloband
