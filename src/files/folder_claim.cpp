#include "files/folder_claim.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <thread>

namespace kiloband {
namespace {

constexpr std::chrono::milliseconds kPause{2};

}  // namespace

FolderClaim::FolderClaim(const std::filesystem::path& folder, Clock::time_point give_up)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  while (descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if ((errno != EWOULDBLOCK && errno != EINTR) || Clock::now() > give_up) return;
    std::this_thread::sleep_for(kPause);
  }
}

FolderClaim::~FolderClaim() {
  if (descriptor_ >= 0) close(descriptor_);  // and with it the lock
}

}  // namespace kiloband
