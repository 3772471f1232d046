#include "src_gpu/device/neutral_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <mutex>

namespace kiloband::opencl {
namespace {

/// The process has one current folder.
struct Place {
  std::recursive_mutex mutex;
  int left = -1;        // descriptor of the folder that was left; -1: none was
  unsigned living = 0;  // NeutralFolders
};

Place& place() {
  static Place the_place;
  return the_place;
}

void leave(Place& here) {
  const int folder = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  if (fchdir(folder) == 0 && chdir("/") == 0) {
    here.left = folder;
  } else {
    close(folder);
  }
}

/// That it can be entered was tried: it fails only where the right to enter is taken away in between, and then
/// relative names are of no use any more.
bool enter_left_folder(const Place& here) {
  return here.left >= 0 && fchdir(here.left) == 0;
}

}  // namespace

NeutralFolder::NeutralFolder() {
  Place& here = place();
  const std::lock_guard lock(here.mutex);
  if (here.living++ == 0) leave(here);
}

NeutralFolder::~NeutralFolder() {
  Place& here = place();
  const std::lock_guard lock(here.mutex);
  if (--here.living > 0) return;
  enter_left_folder(here);
  if (here.left >= 0) close(here.left);
  here.left = -1;
}

NeutralFolder::Visit::Visit() {
  Place& here = place();
  std::unique_lock lock(here.mutex);
  if (here.living != 1 || !enter_left_folder(here)) return;
  outside_ = true;
  lock.release();  // until the visit ends
}

NeutralFolder::Visit::~Visit() {
  if (!outside_) return;
  Place& here = place();
  const std::lock_guard lock(here.mutex, std::adopt_lock);
  if (chdir("/") != 0) return;  // which can always be entered
}

}  // namespace kiloband::opencl
