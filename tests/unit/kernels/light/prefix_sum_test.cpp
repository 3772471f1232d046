// Sums over the work-items of a group, for groups of any size.
#include <numeric>

#include "support.hpp"

namespace kiloband::test::prefix_sum_test {
namespace {

OpenclProbe& probe() {
  static OpenclProbe instance(R"(
#include "base/prefix_sum.clh"
__kernel void sums(__global const kb_u32* x, __global kb_u32* sum) {
  __local kb_u32 room[1024];
  sum[get_global_id(0)] = group_prefix_sum(x[get_global_id(0)], room);
}
)");
  return instance;
}

TEST(PrefixSum, CountsUpToEachWorkItem) {
  std::mt19937 random(4);
  for (const std::size_t group : {1, 2, 3, 7, 64, 100, 256, 1024}) {
    SCOPED_TRACE(group);
    std::vector<uint32_t> x(3 * group), expected(x.size());
    for (uint32_t& one : x) one = random() % 3;
    for (std::size_t g = 0; g < 3; ++g)
      std::partial_sum(x.begin() + static_cast<std::ptrdiff_t>(g * group),
                       x.begin() + static_cast<std::ptrdiff_t>((g + 1) * group),
                       expected.begin() + static_cast<std::ptrdiff_t>(g * group));
    const cl::Buffer from = probe().upload(x), to = probe().upload(std::vector<uint32_t>(x.size()));
    cl::Kernel kernel(probe().program, "sums");
    kernel.setArg(0, from);
    kernel.setArg(1, to);
    probe().queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(x.size()), cl::NDRange(group));
    EXPECT_EQ(probe().download<uint32_t>(to, x.size()), expected);
  }
}

}  // namespace
}  // namespace kiloband::test::prefix_sum_test
