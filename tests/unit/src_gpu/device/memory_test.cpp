// Buffers: transfers, the budget and its account.
#include "src_gpu/device/memory.hpp"

#include <numeric>
#include <stdexcept>

#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

class Memory : public GpuTest {};

std::vector<uint32_t> ramp(std::size_t count) {
  std::vector<uint32_t> values(count);
  std::iota(values.begin(), values.end(), 1000u);
  return values;
}

TEST_F(Memory, UploadsAndDownloads) {
  const std::vector<uint32_t> values = ramp(1000);
  DeviceBuffer<uint32_t> buffer = memory_.upload("ramp", values);
  EXPECT_EQ(buffer.size(), 1000u);
  EXPECT_EQ(buffer.bytes(), 4000u);
  EXPECT_EQ(buffer.download(), values);
  EXPECT_EQ(buffer.read(999), 1999u);
  const std::vector<uint32_t> two{1, 2};
  buffer.upload(two, 500);
  std::vector<uint32_t> part(4);
  buffer.download(part, 499);
  EXPECT_EQ(part, (std::vector<uint32_t>{1499, 1, 2, 1502}));
}

TEST_F(Memory, Fills) {
  auto a = memory_.allocate<uint64_t>("a", 8);
  a.clear();
  EXPECT_EQ(a.download(), std::vector<uint64_t>(8, 0));
  a.fill(uint64_t{1} << 40);
  a.fill(7, 2, 3);
  const uint64_t big = uint64_t{1} << 40;
  EXPECT_EQ(a.download(), (std::vector<uint64_t>{big, big, 7, 7, 7, big, big, big}));
}

struct Odd {  // no pattern of clEnqueueFillBuffer has its size
  uint32_t x, y, z;
};

TEST_F(Memory, ClearsRecordsOfAnySize) {
  auto buffer = memory_.allocate<Odd>("odd", 5);
  const std::vector<Odd> ones(5, Odd{1, 1, 1});
  buffer.upload(ones);
  buffer.clear();
  for (const Odd& odd : buffer.download()) EXPECT_EQ(odd.x + odd.y + odd.z, 0u);
}

TEST_F(Memory, NothingIsSafe) {
  auto buffer = memory_.upload("empty", std::vector<float>{});
  EXPECT_TRUE(buffer.empty());
  EXPECT_NE(buffer.cl_buffer()(), nullptr) << "kernels get a pointer";
  buffer.clear();
  buffer.fill(1.0f);
  EXPECT_TRUE(buffer.download().empty());
  DeviceBuffer<float> none;
  EXPECT_TRUE(none.empty());
  EXPECT_TRUE(none.download().empty());
}

TEST_F(Memory, BeyondTheEndIsOurBug) {
  auto buffer = memory_.allocate<uint32_t>("film", 4);
  std::vector<uint32_t> five(5);
  EXPECT_EQ(message_of<std::logic_error>([&] { buffer.upload(five); }),
            "buffer 'film' has 16 bytes: 20 from 0 on were asked for");
  EXPECT_THROW(buffer.read(4), std::logic_error);
  EXPECT_THROW(buffer.fill(1, 3, 2), std::logic_error);
}

TEST_F(Memory, CountsUseAndPeak) {
  DeviceMemory memory(context_, 10000);
  EXPECT_EQ(memory.budget(), 10000u);
  {
    auto a = memory.allocate<float>("a", 1000);
    auto b = memory.allocate<float>("b", 500);
    EXPECT_EQ(memory.used(), 6000u);
    a = DeviceBuffer<float>();
    EXPECT_EQ(memory.used(), 2000u);
    a = memory.allocate<float>("a", 250);
    auto moved = std::move(a);
    EXPECT_EQ(memory.used(), 3000u);
    EXPECT_EQ(memory.available(), 7000u);
    EXPECT_EQ(memory.largest(), 7000u);
  }
  EXPECT_EQ(memory.used(), 0u);
  EXPECT_EQ(memory.peak(), 6000u);
}

TEST_F(Memory, BufferOutlivesItsAccountant) {
  DeviceBuffer<uint32_t> buffer;
  {
    DeviceMemory memory(context_, 1000);
    buffer = memory.upload("ramp", ramp(3));
  }
  EXPECT_EQ(buffer.download(), ramp(3));
}

TEST_F(Memory, BeyondTheBudget) {
  DeviceMemory memory(context_, 4 << 20);
  auto held = memory.allocate<char>("paths", 3 << 20);
  const std::string message =
      message_of<DeviceOutOfMemory>([&] { memory.allocate<char>("film", (1 << 20) + 1); });
  EXPECT_EQ(message, "device '" + context_.device().name +
                         "': no memory for buffer 'film' of 1.0 MiB (3.0 MiB of a budget of 4.0 MiB in use)");
  EXPECT_EQ(memory.used(), 3u << 20) << "a refused allocation costs nothing";
  auto fits = memory.allocate<char>("film", 1 << 20);
  EXPECT_EQ(memory.available(), 0u);
}

TEST_F(Memory, HugeCountsDoNotWrapAround) {
  const uint64_t half = uint64_t{1} << 63;
  EXPECT_THROW(memory_.allocate<uint64_t>("huge", half), DeviceOutOfMemory);
  EXPECT_THROW(memory_.allocate<uint64_t>("huge", half / 4 + 1), DeviceOutOfMemory);
}

TEST_F(Memory, BeyondTheLargestBuffer) {
  DeviceMemory memory(context_, ~uint64_t{0});
  const uint64_t limit = context_.device().max_allocation;
  EXPECT_EQ(memory.largest(), limit);
  const std::string message =
      message_of<DeviceOutOfMemory>([&] { memory.allocate<char>("film", limit + 1); });
  EXPECT_NE(message.find("no buffer beyond"), std::string::npos) << message;
}

TEST(MemoryBudget, LeavesTheHostItsMemory) {
  DeviceInfo device;
  device.global_memory = uint64_t{100} << 30;
  device.type = DeviceType::kGpu;
  EXPECT_EQ(default_memory_budget(device), device.global_memory / 10 * 7);
  device.type = DeviceType::kCpu;
  EXPECT_EQ(default_memory_budget(device), uint64_t{2} << 30);
  device.global_memory = uint64_t{4} << 30;
  EXPECT_EQ(default_memory_budget(device), uint64_t{1} << 30);
}

TEST_F(Memory, WorksAgainAfterRebuild) {
  auto before = memory_.upload("ramp", ramp(10));
  context_.rebuild();
  EXPECT_EQ(context_.generation(), 1u);
  before = memory_.upload("ramp", ramp(20));
  EXPECT_EQ(before.download(), ramp(20));
}

}  // namespace
}  // namespace kiloband::opencl::test
