// Binaries of programs on disk, $XDG_CACHE_HOME/kiloband/programs or ~/.cache/kiloband/programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "src_gpu/device/device.hpp"

namespace kiloband::opencl {

/// 128 bits of FNV-1a of the text as 32 hex digits: names of programs. Twice the bits of other hashes: a name is
/// all that says that a stored program is the one asked for, and a wrong one would render. Not for secrets.
std::string text_hash(std::string_view text);

/// Files of one folder, named by key. Whatever goes wrong (no folder, no permission, a full disk, a damaged
/// or foreign file) is no error: load gives nothing, and save says why it did nothing. Files are written under another
/// name and renamed, so that processes side by side never see half of one.
class ProgramCache {
 public:
  /// The folder of this user; nothing is created before the first save. Where neither
  /// XDG_CACHE_HOME (absolute) nor HOME is set, there is no cache.
  static ProgramCache of_user();
  explicit ProgramCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// What decides whether a binary fits: the source, the build options, the device,
  /// its driver and its platform.
  static std::string key(const std::string& source, const std::string& options, const DeviceInfo& device);

  std::optional<std::vector<unsigned char>> load(const std::string& key) const;
  /// Returns why the binary could not be kept, "cannot write '/cache/kiloband/programs': Permission denied"; empty if it was, or if there is no cache.
  std::string save(const std::string& key, const std::vector<unsigned char>& binary) const;
  std::filesystem::path file(const std::string& key) const { return folder_ / (key + ".bin"); }

 private:
  std::filesystem::path folder_;  // empty: no cache
};

}  // namespace kiloband::opencl
