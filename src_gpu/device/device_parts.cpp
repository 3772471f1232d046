// Several devices at once, and parts of devices.
#include <algorithm>

#include "base/error.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "src_gpu/device/device.hpp"
#include "src_gpu/device/errors.hpp"

namespace kiloband::opencl {
namespace {

/// "0/2": device 0 in two parts.
struct Choice {
  std::string device;
  uint32_t parts = 1;
};

Choice parse_choice(const std::string& text) {
  const std::size_t slash = text.rfind('/');
  if (slash == std::string::npos) return {text};
  const auto parts = whole_number<uint32_t>(std::string_view(text).substr(slash + 1));
  if (!parts) return {text};  // of a name
  if (*parts == 0) throw InputError("--device " + text + ": must be at least 1 part");
  return {text.substr(0, slash), *parts};
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> pieces;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    pieces.emplace_back(trimmed(std::string_view(text).substr(begin, comma - begin)));
    begin = comma + 1;
  }
  return pieces;
}

/// Equal parts; where the compute units do not go up in them, some stay idle.
std::vector<DeviceInfo> divide(const DeviceInfo& device, uint32_t parts) {
  if (parts == 1) return {device};
  const std::string wanted = "device " + std::to_string(device.index) + " '" + device.name + "' in " +
                             std::to_string(parts) + " parts";
  if (parts > device.compute_units)
    throw InputError(wanted + ": it has " + std::to_string(device.compute_units) + " compute units");
  std::vector<cl::Device> pieces;
  const cl_device_partition_property equally[] = {
      CL_DEVICE_PARTITION_EQUALLY, static_cast<cl_device_partition_property>(device.compute_units / parts),
      0};
  try {
    cl::Device(device.id, true).createSubDevices(equally, &pieces);
  } catch (const cl::Error& error) {
    throw InputError(wanted + ": its driver refuses (" + error_name(error.err()) + ")");
  }
  pieces.resize(std::min<std::size_t>(pieces.size(), parts));
  std::vector<DeviceInfo> divided;
  for (const cl::Device& piece : pieces) {
    DeviceInfo& info = divided.emplace_back(device);
    info.compute_units = device.compute_units / parts;
    info.global_memory = device.global_memory / parts;
    info.max_allocation = std::min(device.max_allocation, info.global_memory);
    info.id = piece();
    info.kept = std::make_shared<cl::Device>(piece);
  }
  return divided;
}

}  // namespace

std::vector<DeviceInfo> select_devices(const std::vector<DeviceInfo>& devices,
                                       const std::optional<std::string>& choice) {
  if (choice && *choice == "all" && !devices.empty()) return devices;
  if (!choice) return {select_device(devices, choice)};
  std::vector<DeviceInfo> selected;
  std::vector<uint32_t> taken;
  for (const std::string& text : split_at_commas(*choice)) {
    const Choice one = parse_choice(text);
    const DeviceInfo device = select_device(devices, one.device);
    if (std::ranges::find(taken, device.index) != taken.end())
      throw InputError("--device " + *choice + ": device " + std::to_string(device.index) + " '" +
                       device.name + "' is named twice");
    taken.push_back(device.index);
    std::ranges::move(divide(device, one.parts), std::back_inserter(selected));
  }
  return selected;
}

std::vector<DeviceInfo> select_devices(const std::optional<std::string>& choice) {
  if (!choice) return {select_device(choice)};
  select_device(std::nullopt);  // that there is one
  return select_devices(list_devices(), choice);
}

}  // namespace kiloband::opencl
