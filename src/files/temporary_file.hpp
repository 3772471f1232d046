// Files that have no name until they are complete.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace kiloband {

struct TemporaryName;

/// A new file for writing in a folder. Where the file system can do it (O_TMPFILE: ext4, XFS, Btrfs, tmpfs),
/// it has no name until publish(), so that whatever ends the process, kill -9 included, leaves nothing
/// behind. Elsewhere (NFS, FAT ...) it has a name of 64 random bits, ".kiloband-<hex>.partial", made
/// exclusively, which discard(), the destructor and remove_temporary_files() remove. Every call that can fail
/// returns 0 or errno's value.
class TemporaryFile {
 public:
  TemporaryFile() = default;
  ~TemporaryFile() { discard(); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// folder: empty for the working directory; mode: permissions, of which the umask takes its own
  int create(const std::filesystem::path& folder, mode_t mode = 0666);
  /// What create() does where files cannot be without a name.
  int create_named(const std::filesystem::path& folder, mode_t mode = 0666);
  /// In the system's temporary folder (TMPDIR), for this user alone, also for reading; never to be published.
  int create_scratch();
  /// Where it is, or was to be.
  const std::filesystem::path& folder() const { return folder_; }
  /// Open until publish() or discard(); -1 otherwise.
  int descriptor() const { return descriptor_; }
  /// Closes the file and gives it its name, in its folder, in place of what has it now.
  int publish(const std::filesystem::path& target);
  void discard() noexcept;

 private:
  int give_temporary_name();

  std::filesystem::path folder_;
  TemporaryName* name_ = nullptr;  // none yet
  int descriptor_ = -1;
};

/// Removes all names that TemporaryFile has made in this process. For signal handlers that end the process:
/// async-signal-safe. Does nothing in a child process.
void remove_temporary_files() noexcept;

}  // namespace kiloband
