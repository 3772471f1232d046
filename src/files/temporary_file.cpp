#include "files/temporary_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>

namespace kiloband {

/// A name that a signal handler may remove at any moment. Neither entries nor their texts are ever changed or
/// freed (some 100 bytes per name), so that it cannot meet half of one.
struct TemporaryName {
  const std::filesystem::path path;
  std::atomic<bool> stands = true;  // or is about to
  TemporaryName* next = nullptr;
};

namespace {

std::atomic<TemporaryName*> names = nullptr;
std::atomic<pid_t> owner = 0;

TemporaryName* add_name(std::filesystem::path path) {
  owner = getpid();
  auto* name = new TemporaryName{std::move(path)};
  name->next = names;
  while (!names.compare_exchange_weak(name->next, name)) {
  }
  return name;
}

/// Not to be guessed: who may write to the folder, too, cannot put anything there beforehand.
std::filesystem::path random_name(const std::filesystem::path& folder) {
  std::random_device random;
  const uint64_t bits = uint64_t{random()} << 32 | random();
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(bits));
  return folder / (std::string(".kiloband-") + hex + ".partial");
}

std::string link_of(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

/// A file without a name; -1 where the file system has no such thing, or where it could not be named later.
int open_nameless(const std::filesystem::path& folder, int flags, mode_t mode) {
  const int descriptor = open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_CLOEXEC | flags, mode);
  if (descriptor < 0 || access(link_of(descriptor).c_str(), F_OK) == 0) return descriptor;
  close(descriptor);
  return -1;
}

/// Opens a file of a new name; null and errno on failure.
TemporaryName* open_named(const std::filesystem::path& folder, int flags, mode_t mode, int& descriptor) {
  for (;;) {
    TemporaryName* name = add_name(random_name(folder));
    descriptor = open(name->path.c_str(), O_CREAT | O_EXCL | O_CLOEXEC | flags, mode);
    if (descriptor >= 0) return name;
    name->stands = false;
    if (errno != EEXIST) return nullptr;
  }
}

}  // namespace

int TemporaryFile::create(const std::filesystem::path& folder, mode_t mode) {
  folder_ = folder;
  descriptor_ = open_nameless(folder, O_WRONLY, mode);
  return descriptor_ >= 0 ? 0 : create_named(folder, mode);
}

int TemporaryFile::create_named(const std::filesystem::path& folder, mode_t mode) {
  folder_ = folder;
  name_ = open_named(folder, O_WRONLY, mode, descriptor_);
  return name_ ? 0 : errno;
}

int TemporaryFile::give_temporary_name() {
  const std::string file = link_of(descriptor_);
  for (;;) {
    TemporaryName* name = add_name(random_name(folder_));
    if (linkat(AT_FDCWD, file.c_str(), AT_FDCWD, name->path.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      name_ = name;
      return 0;
    }
    name->stands = false;
    if (errno != EEXIST) return errno;
  }
}

int TemporaryFile::publish(const std::filesystem::path& target) {
  // A link cannot replace a file, a rename can: a name for this moment.
  if (!name_) {
    if (const int error = give_temporary_name(); error != 0) return error;
  }
  // Network file systems report late write errors when a file is closed.
  const bool closed = close(descriptor_) == 0;
  descriptor_ = -1;
  const bool renamed = closed && rename(name_->path.c_str(), target.c_str()) == 0;
  const int error = renamed ? 0 : errno;
  if (renamed) name_->stands = false;
  discard();
  return error;
}

void TemporaryFile::discard() noexcept {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
  if (name_ && name_->stands) unlink(name_->path.c_str());
  if (name_) name_->stands = false;
  name_ = nullptr;
}

int TemporaryFile::create_scratch() {
  std::error_code error;
  folder_ = std::filesystem::temp_directory_path(error);
  if (error) {
    const char* wanted = std::getenv("TMPDIR");
    folder_ = wanted ? wanted : "/tmp";
    return error.value();
  }
  descriptor_ = open_nameless(folder_, O_RDWR, 0600);
  if (descriptor_ >= 0) return 0;
  TemporaryName* name = open_named(folder_, O_RDWR, 0600, descriptor_);
  if (!name) return errno;
  unlink(name->path.c_str());
  name->stands = false;
  return 0;
}

void remove_temporary_files() noexcept {
  if (owner != getpid()) return;
  for (const TemporaryName* name = names; name; name = name->next) {
    if (name->stands) unlink(name->path.c_str());
  }
}

}  // namespace kiloband
