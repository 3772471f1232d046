// kiloband devices: the OpenCL devices that --device can choose.
#include <fmt/core.h>

#include <algorithm>

#include "app/commands.hpp"
#include "app/console/standard_output.hpp"
#include "src_gpu/device/device.hpp"

namespace kiloband {
namespace {

double gibibytes(uint64_t bytes) {
  return static_cast<double>(bytes) / (1024.0 * 1024.0 * 1024.0);
}

void print_table(const std::vector<opencl::DeviceInfo>& devices) {
  std::size_t name = 4, platform = 8;  // widths of the columns
  for (const opencl::DeviceInfo& device : devices) {
    name = std::max(name, device.name.size());
    platform = std::max(platform, device.platform.size());
  }
  answer("{:>5}  {:<{}}  {:<11}  {:<{}}  {:>5}  {:>11}\n", "index", "name", name, "type", "platform",
         platform, "units", "memory");
  for (const opencl::DeviceInfo& device : devices) {
    answer("{:>5}  {:<{}}  {:<11}  {:<{}}  {:>5}  {:>7.1f} GiB\n", device.index, device.name, name,
           to_string(device.type), device.platform, platform, device.compute_units,
           gibibytes(device.global_memory));
  }
}

/// That there is none is an answer, not a failure: scripts ask to find out.
int devices() {
  const std::vector<opencl::DeviceInfo> found = opencl::list_devices();
  if (found.empty()) {
    answer(
        "no OpenCL device\n"
        "For a GPU install its vendor's OpenCL driver, for a processor PoCL (Debian: pocl-opencl-icd).\n"
        "Rendering on the CPU (--backend cpu) needs none.\n");
    return kDone;
  }
  print_table(found);
  return kDone;
}

}  // namespace

Command add_devices(CLI::App& program) {
  program.add_subcommand("devices", "List the OpenCL devices");
  return devices;
}

}  // namespace kiloband
