// The measurements of `kiloband tune` on disk, a file for each device: $XDG_CACHE_HOME/kiloband/tuning or ~/.cache/kiloband/tuning.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "src_gpu/tuning/tuning.hpp"

namespace kiloband::opencl {

class TuningStore {
 public:
  /// The folder of this user; nothing is created before the first save. There is none where neither XDG_CACHE_HOME (absolute) nor HOME
  /// is set.
  static TuningStore of_user();
  explicit TuningStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Of this device with this driver. Whatever is wrong with the file (it is not there, damaged, of another version, has
  /// sizes that no device has, cannot be read) is no error: nothing is tuned then.
  std::vector<TunedMethod> load(const DeviceInfo& device) const;

  /// Why save() could keep nothing, before anything is measured; empty where it could. Makes the folder.
  std::string refusal(const DeviceInfo& device) const;

  /// Adds a measurement; it takes the place of an earlier one with the same method and number of channels. Others at the same time,
  /// of other processes, too, are kept as well (FolderClaim).
  /// Returns why it could not be kept; empty if it was.
  std::string save(const DeviceInfo& device, const TunedMethod& measured) const;

  /// Forgets all of the device. Returns whether there was anything.
  /// throws DeviceError  the file cannot be removed
  bool forget(const DeviceInfo& device) const;

  /// Empty where there is no store.
  std::filesystem::path file(const DeviceInfo& device) const;

 private:
  std::filesystem::path folder_;  // empty: no store
};

}  // namespace kiloband::opencl
