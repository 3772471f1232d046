// An exclusive lock on a folder, for what must not be done by two processes at once.
#pragma once

#include <chrono>
#include <filesystem>

namespace kiloband {

/// The lock of a folder (flock), until it is destroyed; none if it cannot be had: the folder cannot be locked (NFS), or somebody holds
/// the lock until `give_up`. The kernel releases it when its holder ends, however that happens; there is no
/// lock file that could be left over, and reading the folder suffices to lock it.
class FolderClaim {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kPatience{10};

  explicit FolderClaim(const std::filesystem::path& folder,
                       Clock::time_point give_up = Clock::now() + kPatience);
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;

 private:
  int descriptor_;
};

}  // namespace kiloband
