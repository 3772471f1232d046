#include "files/file_set.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "files/folder_claim.hpp"

namespace kiloband {
namespace {

std::filesystem::path folder_of(const AtomicFile& file) {
  const auto folder = file.target().file.parent_path();
  return folder.empty() ? "." : folder;
}

/// Each once, and in the same order in every process: two that wait for each other would wait for ever.
using Folders = std::map<std::pair<dev_t, ino_t>, std::filesystem::path>;

Folders folders_of(const std::vector<AtomicFile*>& files) {
  Folders folders;
  for (const AtomicFile* file : files) {
    struct stat status = {};
    const auto folder = folder_of(*file);
    if (!file->target().special && stat(folder.c_str(), &status) == 0)
      folders.emplace(std::pair(status.st_dev, status.st_ino), folder);
  }
  return folders;
}

}  // namespace

void FileSet::commit() {
  for (AtomicFile* file : files_) file->flush();  // what takes long comes before the claim
  const Folders folders = folders_of(files_);
  std::vector<std::unique_ptr<FolderClaim>> claims;
  const bool special = std::ranges::any_of(files_, [](const AtomicFile* f) { return f->target().special; });
  const auto give_up = FolderClaim::Clock::now() + FolderClaim::kPatience;
  for (const auto& [identity, folder] : folders) {
    if (!special) claims.push_back(std::make_unique<FolderClaim>(folder, give_up));
  }
  for (const auto& action : before_) action();
  for (AtomicFile* file : files_) file->publish();
  check_all_stand();
  for (const auto& [identity, folder] : folders) flush_folder(folder);
}

void FileSet::check_all_stand() const {
  const auto lost = std::ranges::find_if(files_, [](const AtomicFile* file) { return !file->stands(); });
  if (lost == files_.end()) return;
  for (auto file = files_.rbegin(); file != files_.rend(); ++file) {
    if (!(*file)->target().special && (*file)->stands()) unlink((*file)->target().file.c_str());
  }
  throw DeviceError("cannot write '" + (*lost)->name().string() +
                    "': another process has written it at the same time");
}

}  // namespace kiloband
