#include "src_gpu/device/device.hpp"

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "base/number.hpp"
#include "base/text.hpp"
#include "base/threads.hpp"
#include "src_gpu/device/errors.hpp"
#include "src_gpu/device/pocl_cache.hpp"

namespace kiloband::opencl {
namespace {

/// Drivers pad names with spaces and end them with zeros.
std::string unpadded(const std::string& name) {
  return std::string(trimmed(std::string_view(name).substr(0, name.find('\0'))));
}

/// PoCL ends the process where it cannot have a thread per processor, and starts a linker.
void check_threads_of_drivers() {
  static const bool kChecked = [] {  // before they have started theirs
    require_threads(std::thread::hardware_concurrency() + 1, "the OpenCL drivers",
                    "use --backend cpu with fewer --threads");
    return true;
  }();
  static_cast<void>(kChecked);
}

std::vector<cl::Platform> list_platforms() {
  prepare_opencl_environment();
  check_threads_of_drivers();
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error& e) {
    // The answer of an ICD loader that finds no driver.
    if (e.err() == CL_PLATFORM_NOT_FOUND_KHR) return {};
    throw DeviceError(std::string("OpenCL: ") + e.what() + ": " + error_name(e.err()) + " (" +
                      std::to_string(e.err()) + ")");
  }
  return platforms;
}

/// "OpenCL 1.2 ...": at least 1.2, with a compiler, and not out of order.
bool is_usable(const cl::Device& device) {
  const std::string version = device.getInfo<CL_DEVICE_VERSION>();
  const std::string prefix = "OpenCL ";
  if (version.rfind(prefix, 0) != 0) return false;
  const double number = std::atof(version.c_str() + prefix.size());
  return number > 1.15 && device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() &&
         device.getInfo<CL_DEVICE_AVAILABLE>();
}

DeviceType type_of(cl_device_type type) {
  if (type & CL_DEVICE_TYPE_GPU) return DeviceType::kGpu;
  if (type & CL_DEVICE_TYPE_ACCELERATOR) return DeviceType::kAccelerator;
  return DeviceType::kCpu;
}

DeviceInfo describe(const cl::Platform& platform, const cl::Device& device) {
  DeviceInfo info;
  info.name = unpadded(device.getInfo<CL_DEVICE_NAME>());
  info.vendor = unpadded(device.getInfo<CL_DEVICE_VENDOR>());
  info.platform = unpadded(platform.getInfo<CL_PLATFORM_NAME>());
  info.platform_version = unpadded(platform.getInfo<CL_PLATFORM_VERSION>());
  info.driver_version = unpadded(device.getInfo<CL_DRIVER_VERSION>());
  info.type = type_of(device.getInfo<CL_DEVICE_TYPE>());
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  info.global_memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.max_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  info.max_work_group_size = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
  info.id = device();
  return info;
}

void append_devices(const cl::Platform& platform, std::vector<DeviceInfo>& found) {
  std::vector<cl::Device> devices;
  try {
    platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
  } catch (const cl::Error&) {
    return;  // none, or a driver that does not find its hardware
  }
  for (const cl::Device& device : devices) {
    try {
      if (is_usable(device)) found.push_back(describe(platform, device));
    } catch (const cl::Error&) {
      continue;  // a device that cannot even tell its name
    }
  }
}

/// "0 'NVIDIA H100', 1 'pthread-...'"
std::string names_of(const std::vector<DeviceInfo>& devices) {
  std::string text;
  for (const DeviceInfo& device : devices) {
    if (!text.empty()) text += ", ";
    text += std::to_string(device.index) + " '" + device.name + "'";
  }
  return text;
}

DeviceInfo default_device(const std::vector<DeviceInfo>& devices) {
  return *std::min_element(devices.begin(), devices.end(),
                           [](const DeviceInfo& a, const DeviceInfo& b) { return a.type < b.type; });
}

DeviceInfo device_of_index(const std::vector<DeviceInfo>& devices, const std::string& choice) {
  if (const std::optional<uint32_t> index = whole_number<uint32_t>(choice)) {
    for (const DeviceInfo& device : devices) {
      if (device.index == *index) return device;
    }
  }
  throw InputError("no OpenCL device " + choice + ": there is " + names_of(devices));
}

DeviceInfo device_of_name(const std::vector<DeviceInfo>& devices, const std::string& choice) {
  const std::string wanted = lowered(choice);
  std::vector<DeviceInfo> exact, partial;
  for (const DeviceInfo& device : devices) {
    const std::string name = lowered(device.name);
    if (name == wanted) exact.push_back(device);
    if (name.find(wanted) != std::string::npos) partial.push_back(device);
  }
  const std::vector<DeviceInfo>& matches = exact.empty() ? partial : exact;
  if (matches.empty() || choice.empty()) {
    throw InputError("no OpenCL device has '" + choice + "' in its name: there is " + names_of(devices));
  }
  if (matches.size() > 1) {
    throw InputError("several OpenCL devices have '" + choice +
                     "' in their names, give the number: " + names_of(matches));
  }
  return matches.front();
}

void require_platform() {
  if (list_platforms().empty())
    throw DeviceError("no OpenCL platform: no OpenCL driver is installed (for processors: pocl-opencl-icd)");
}

}  // namespace

const char* to_string(DeviceType type) {
  switch (type) {
    case DeviceType::kGpu:
      return "gpu";
    case DeviceType::kAccelerator:
      return "accelerator";
    case DeviceType::kCpu:
      break;
  }
  return "cpu";
}

void prepare_opencl_environment() {
  static const int kDone = setenv("POCL_WORK_GROUP_METHOD", "loops", 0);
  static_cast<void>(kDone);
  prepare_pocl_cache();
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> found;
  for (const cl::Platform& platform : list_platforms()) append_devices(platform, found);
  for (std::size_t i = 0; i < found.size(); ++i) found[i].index = static_cast<uint32_t>(i);
  return found;
}

DeviceInfo select_device(const std::vector<DeviceInfo>& devices, const std::optional<std::string>& choice) {
  if (devices.empty()) {
    const std::string problem = pocl_cache_problem();
    throw DeviceError("no OpenCL device: the OpenCL drivers here have none" +
                      (problem.empty() ? "" : "; " + problem));
  }
  if (!choice) return default_device(devices);
  const bool is_number = !choice->empty() && std::all_of(choice->begin(), choice->end(),
                                                         [](unsigned char c) { return std::isdigit(c); });
  return is_number ? device_of_index(devices, *choice) : device_of_name(devices, *choice);
}

DeviceInfo select_device(const std::optional<std::string>& choice) {
  require_platform();
  return select_device(list_devices(), choice);
}

}  // namespace kiloband::opencl
