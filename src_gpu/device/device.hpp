// OpenCL devices of this machine: what there is, and which one to use.
// No OpenCL header is needed to include this.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

struct _cl_device_id;

namespace kiloband::opencl {

enum class DeviceType { kGpu, kAccelerator, kCpu };

/// "gpu", "accelerator", "cpu"
const char* to_string(DeviceType type);

struct DeviceInfo {
  uint32_t index = 0;  // over the devices of all platforms, from 0: what --device takes
  std::string name, vendor, platform;
  std::string platform_version, driver_version;
  DeviceType type = DeviceType::kCpu;
  uint32_t compute_units = 0;
  uint64_t global_memory = 0;   // bytes
  uint64_t max_allocation = 0;  // bytes, of one buffer
  uint64_t max_work_group_size = 0;
  _cl_device_id* id = nullptr;
  std::shared_ptr<void> kept;  // of a part: what keeps `id` valid

  /// PoCL: needs settings of its own.
  bool is_pocl() const { return platform == "Portable Computing Language"; }
};

/// To be called before the first OpenCL call of the process (list_devices and select_device do). PoCL's
/// default way of running work-groups traverses 7 to 9 times slower than "loops": POCL_WORK_GROUP_METHOD is
/// set unless the user has set it; and it gets a folder that it can compile in (pocl_cache.hpp). Other
/// platforms read neither. Not to be called while other threads read the environment.
void prepare_opencl_environment();

/// All devices of all platforms; empty without a platform or a device. A platform whose devices cannot be
/// listed is passed over.
/// throws DeviceError  the loader itself fails; too few threads can be started (PoCL would end the process)
std::vector<DeviceInfo> list_devices();

/// The device to use.
/// choice  an index, or a part of a name whatever the case (an exact name wins over names that contain it);
///         nothing: the first GPU, else accelerator, else CPU
/// throws DeviceError  no OpenCL platform or no device
///        InputError   no such index or name (lists what there is), or a name that several devices have
DeviceInfo select_device(const std::optional<std::string>& choice);

/// The same among given devices.
DeviceInfo select_device(const std::vector<DeviceInfo>& devices, const std::optional<std::string>& choice);

/// The devices to use together.
/// choice  as of select_device(); several of them with commas between; "all"; behind an index or a name "/N":
///         the device in N equal parts, each a device that has its share of compute units and memory
/// throws as select_device()
///        InputError  a device twice; a device that cannot be divided so
std::vector<DeviceInfo> select_devices(const std::optional<std::string>& choice);

/// The same among given devices.
std::vector<DeviceInfo> select_devices(const std::vector<DeviceInfo>& devices,
                                       const std::optional<std::string>& choice);

}  // namespace kiloband::opencl
