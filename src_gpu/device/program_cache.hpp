// Binaries of programs on disk, $XDG_CACHE_HOME/kiloband/programs or ~/.cache/kiloband/programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "src_gpu/device/device.hpp"

namespace kiloband::opencl {

/// Files of one folder, named by key. Whatever goes wrong (no folder, no permission, a full disk, a damaged
/// or foreign file) is no error: load gives nothing, and save says why it did nothing.
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
