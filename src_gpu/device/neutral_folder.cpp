#include "src_gpu/device/neutral_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace kiloband::opencl {

NeutralFolder::NeutralFolder() {
  const int here = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (here < 0) return;
  if (fchdir(here) == 0 && chdir("/") == 0) {
    left_ = here;
  } else {
    close(here);
  }
}

NeutralFolder::~NeutralFolder() {
  enter_left_folder();
  if (left_ >= 0) close(left_);
}

void NeutralFolder::enter_left_folder() const {
  // That it can be entered was tried: it fails only where the right to enter is taken away in between, and
  // then relative names are of no use any more.
  if (left_ >= 0 && fchdir(left_) != 0) return;
}

void NeutralFolder::enter_root() const {
  if (left_ >= 0 && chdir("/") != 0) return;
}

}  // namespace kiloband::opencl
