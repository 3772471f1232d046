// Listing and choosing devices.
#include "src_gpu/device/device.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.hpp"
#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

DeviceInfo made_up(uint32_t index, const std::string& name, DeviceType type) {
  DeviceInfo info;
  info.index = index;
  info.name = name;
  info.type = type;
  return info;
}

const std::vector<DeviceInfo> kDevices{
    made_up(0, "pthread-EPYC", DeviceType::kCpu), made_up(1, "FPGA 1", DeviceType::kAccelerator),
    made_up(2, "NVIDIA H100", DeviceType::kGpu), made_up(3, "NVIDIA H100 NVL", DeviceType::kGpu)};
const std::string kAll = "0 'pthread-EPYC', 1 'FPGA 1', 2 'NVIDIA H100', 3 'NVIDIA H100 NVL'";

TEST(SelectDevice, GpuThenAcceleratorThenCpu) {
  EXPECT_EQ(select_device(kDevices, std::nullopt).index, 2u);
  EXPECT_EQ(select_device({kDevices[0], kDevices[1]}, std::nullopt).index, 1u);
  EXPECT_EQ(select_device({kDevices[0]}, std::nullopt).index, 0u);
}

TEST(SelectDevice, ByNumber) {
  for (uint32_t i = 0; i < 4; ++i) EXPECT_EQ(select_device(kDevices, std::to_string(i)).index, i);
  for (const std::string wrong : {"4", "99999999999999999999"}) {
    EXPECT_EQ(message_of<InputError>([&] { select_device(kDevices, wrong); }),
              "no OpenCL device " + wrong + ": there is " + kAll);
  }
}

TEST(SelectDevice, ByName) {
  EXPECT_EQ(select_device(kDevices, "epyc").index, 0u);
  EXPECT_EQ(select_device(kDevices, "nvl").index, 3u);
  // The whole name of one is a part of another's.
  EXPECT_EQ(select_device(kDevices, "nvidia h100").index, 2u);
  EXPECT_EQ(message_of<InputError>([] { select_device(kDevices, "h100"); }),
            "several OpenCL devices have 'h100' in their names, give the number: 2 'NVIDIA H100', 3 'NVIDIA "
            "H100 NVL'");
  for (const std::string wrong : {"radeon", "", "-1"}) {
    EXPECT_EQ(message_of<InputError>([&] { select_device(kDevices, wrong); }),
              "no OpenCL device has '" + wrong + "' in its name: there is " + kAll);
  }
}

TEST(SelectDevice, None) {
  EXPECT_EQ(message_of<DeviceError>([] { select_device(std::vector<DeviceInfo>{}, "0"); }),
            "no OpenCL device: the OpenCL drivers here have none");
}

TEST(ListDevices, DescribesWhatIsThere) {
  const std::vector<DeviceInfo> devices = list_devices();
  ASSERT_FALSE(devices.empty());
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& device = devices[i];
    EXPECT_EQ(device.index, i);
    EXPECT_NE(device.name, "");
    EXPECT_NE(device.platform, "");
    EXPECT_NE(device.driver_version, "");
    EXPECT_EQ(device.name.find('\0'), std::string::npos);
    EXPECT_GE(device.compute_units, 1u);
    EXPECT_GE(device.max_work_group_size, 1u);
    EXPECT_GE(device.max_allocation, device.global_memory / 4);
    EXPECT_NE(device.id, nullptr);
  }
  EXPECT_EQ(select_device("0").name, devices[0].name);
}

TEST(ListDevices, PoclIsToldToUseLoops) {
  list_devices();
  ASSERT_NE(std::getenv("POCL_WORK_GROUP_METHOD"), nullptr);
}

}  // namespace
}  // namespace kiloband::opencl::test
