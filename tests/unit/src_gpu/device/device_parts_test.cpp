// Several devices at once, and parts of devices.
#include <gtest/gtest.h>

#include <set>

#include "base/error.hpp"
#include "src_gpu/device/context.hpp"
#include "src_gpu/device/device.hpp"
#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

DeviceInfo named(uint32_t index, const std::string& name) {
  DeviceInfo info;
  info.index = index;
  info.name = name;
  info.compute_units = 4;
  return info;
}

const std::vector<DeviceInfo> kChoices{named(0, "EPYC"), named(1, "H100"), named(2, "A/2 card")};

std::vector<uint32_t> indices(const std::string& choice) {
  std::vector<uint32_t> found;
  for (const DeviceInfo& device : select_devices(kChoices, choice)) found.push_back(device.index);
  return found;
}

std::string refusal(const std::string& choice) {
  return message_of<InputError>([&] { select_devices(kChoices, choice); });
}

TEST(SelectDevices, TakesListsOfNumbersAndNames) {
  using List = std::vector<uint32_t>;
  EXPECT_EQ(indices("1"), List{1});
  EXPECT_EQ(indices("1,0"), (List{1, 0}));
  EXPECT_EQ(indices(" h100 , epyc "), (List{1, 0}));
  EXPECT_EQ(indices("all"), (List{0, 1, 2}));
  EXPECT_EQ(indices("2/1"), List{2});
  EXPECT_EQ(indices("a/2 card"), List{2});  // no number of parts stands at its end
  EXPECT_EQ(select_devices(kChoices, std::nullopt).size(), 1u);
}

TEST(SelectDevices, Refuses) {
  const std::string all = ": there is 0 'EPYC', 1 'H100', 2 'A/2 card'";
  EXPECT_EQ(refusal("0,7"), "no OpenCL device 7" + all);
  EXPECT_EQ(refusal("0,"), "no OpenCL device has '' in its name" + all);
  EXPECT_EQ(refusal("0,1,epyc"), "--device 0,1,epyc: device 0 'EPYC' is named twice");
  EXPECT_EQ(refusal("0/2,0"), "device 0 'EPYC' in 2 parts: its driver refuses (CL_INVALID_DEVICE)");
  EXPECT_EQ(refusal("1/0"), "--device 1/0: must be at least 1 part");
  EXPECT_EQ(refusal("1/5"), "device 1 'H100' in 5 parts: it has 4 compute units");
  EXPECT_EQ(message_of<DeviceError>([] { select_devices(std::vector<DeviceInfo>{}, "all"); }),
            "no OpenCL device: the OpenCL drivers here have none");
}

TEST(SelectDevices, DividesTheDeviceThatIsHere) {
  const DeviceInfo whole = select_device("0");
  if (whole.compute_units < 2) GTEST_SKIP() << "a device of one compute unit";
  const std::vector<DeviceInfo> halves = select_devices("0/2");
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_NE(halves[0].id, halves[1].id);
  for (const DeviceInfo& half : halves) {
    EXPECT_EQ(half.name, whole.name);
    EXPECT_EQ(half.index, 0u);
    EXPECT_EQ(half.compute_units, whole.compute_units / 2);
    EXPECT_EQ(half.global_memory, whole.global_memory / 2);
    DeviceContext context(half);
    context.finish();
  }
}

}  // namespace
}  // namespace kiloband::opencl::test
