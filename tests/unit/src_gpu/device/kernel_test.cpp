// Arguments, launches and times.
#include "src_gpu/device/kernel.hpp"

#include <stdexcept>

#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

const std::string kCount = R"(
__kernel void count(__global uint* hits, uint items, uint step) {
  uint i = get_global_id(0);
  if (i < items) hits[i] += step;
}
__kernel void group_sum(__global uint* sums, __local uint* scratch) {
  uint l = get_local_id(0);
  scratch[l] = get_global_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  uint sum = 0;
  for (uint i = 0; i < get_local_size(0); ++i) sum += scratch[i];
  if (l == 0) sums[get_group_id(0)] = sum;
}
)";

class KernelTest : public GpuTest {
 protected:
  Program program_ = build(kCount);
  DeviceBuffer<uint32_t> hits_ = memory_.upload("hits", std::vector<uint32_t>(100, 0));
};

TEST_F(KernelTest, LaunchesEachItemOnce) {
  Kernel kernel = program_.kernel("count");
  kernel.set(hits_, 100u, 3u);
  kernel.launch(100);      // the driver's groups
  kernel.launch(100, 16);  // rounded up to 112
  kernel.launch(50, 1);
  kernel.launch(0, 16);  // nothing
  const std::vector<uint32_t> hits = hits_.download();
  for (uint32_t i = 0; i < 100; ++i) EXPECT_EQ(hits[i], i < 50 ? 9u : 6u) << i;
}

TEST_F(KernelTest, SomeArgumentsStay) {
  Kernel kernel = program_.kernel("count");
  kernel.set(hits_, 100u, 3u).launch(100);
  kernel.set_from(2, 5u).launch(100);
  EXPECT_EQ(hits_.download(), std::vector<uint32_t>(100, 8));
}

TEST_F(KernelTest, LocalMemory) {
  auto sums = memory_.allocate<uint32_t>("sums", 2);
  program_.kernel("group_sum").set(sums, LocalArray<uint32_t>{4}).launch(8, 4);
  EXPECT_EQ(sums.download(), (std::vector<uint32_t>{0 + 1 + 2 + 3, 4 + 5 + 6 + 7}));
}

TEST_F(KernelTest, KnowsItself) {
  const Kernel kernel = program_.kernel("count");
  EXPECT_EQ(kernel.name(), "count");
  EXPECT_GE(kernel.max_work_group_size(), 1u);
}

TEST_F(KernelTest, WrongArgumentsAreOurBug) {
  Kernel kernel = program_.kernel("count");
  EXPECT_EQ(message_of<std::logic_error>([&] { kernel.set(hits_, 100u); }),
            "kernel 'count' has 3 arguments, got 2");
  const std::string message = message_of<std::logic_error>([&] { kernel.set(hits_, 100.0, 3u); });
  EXPECT_NE(message.find("argument 1 of kernel 'count': CL_INVALID_ARG_SIZE (-51)"), std::string::npos)
      << message;
  EXPECT_THROW(kernel.set_from(3, 1u), std::logic_error);
  EXPECT_THROW(program_.kernel("nothing"), std::logic_error);
}

TEST_F(KernelTest, TooLargeAGroupIsAsLargeAsItCanBe) {
  Kernel kernel = program_.kernel("count");
  kernel.set(hits_, 100u, 3u).launch(100, context_.device().max_work_group_size * 2);
  EXPECT_EQ(hits_.download(), std::vector<uint32_t>(100, 3));
}

TEST_F(KernelTest, MeasuresTime) {
  Kernel kernel = program_.kernel("count");
  kernel.set(hits_, 100u, 1u);
  const double seconds = kernel.launch_timed(100);
  EXPECT_GT(seconds, 0);
  EXPECT_LT(seconds, 10);
  EXPECT_EQ(kernel.launch_timed(0), 0);
  const cl::Event event = kernel.launch_event(100);
  context_.finish();
  EXPECT_GT(seconds_of(context_, event), 0);
}

TEST_F(KernelTest, NoTimesWithoutProfiling) {
  DeviceContext plain(context_.device());
  DeviceMemory memory(plain);
  auto hits = memory.upload("hits", std::vector<uint32_t>(1));
  Kernel kernel =
      build_program(plain, {{"kernels/test.cl", kCount}}, "kernels/test.cl", {{}, false}).kernel("count");
  kernel.set(hits, 1u, 1u);
  EXPECT_THROW(kernel.launch_timed(1), DeviceError);
  EXPECT_EQ(hits.read(0), 1u);
}

}  // namespace
}  // namespace kiloband::opencl::test
