// The dual-language headers on an OpenCL device (PoCL in automated runs) against the same code on the host:
// bit for bit where only integers and + - * / sqrt occur, within a few ulp where the device has its
// own sin, exp, erf.
//
// Without an OpenCL device the test fails; the environment variable KILOBAND_NO_OPENCL=1 says
// that this is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

#include "shared/sobol_table.h"
#include "tests/support/opencl_probe.hpp"
#include "tests/unit/shared/opencl_probe.h"

namespace kiloband::test {
namespace {

constexpr kb_u32 kItems = 1 << 14;

const char* const kSource = R"(
#include "tests/unit/shared/opencl_probe.h"
__kernel void probe(__global const uint* table, __global uint* exact, __global float* close) {
  kb_probe_item((uint)get_global_id(0), table, exact, close);
}
)";

struct Results {
  std::vector<kb_u32> exact = std::vector<kb_u32>(std::size_t{kItems} * KB_PROBE_EXACT);
  std::vector<float> close = std::vector<float>(std::size_t{kItems} * KB_PROBE_CLOSE);
};

Results host_results() {
  Results r;
  for (kb_u32 i = 0; i < kItems; ++i) kb_probe_item(i, kb_sobol_table, r.exact.data(), r.close.data());
  return r;
}

/// Divisions and square roots are rounded correctly, as the bit-for-bit part needs.
Results device_results() {
  OpenclProbe probe(kSource, "-cl-fp32-correctly-rounded-divide-sqrt -Werror");
  EXPECT_TRUE(probe.device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT);
  const Results r;
  const cl::Buffer table =
      probe.upload(std::vector<kb_u32>(std::begin(kb_sobol_table), std::end(kb_sobol_table)));
  const cl::Buffer exact = probe.upload(r.exact), close = probe.upload(r.close);
  probe.run("probe", kItems, table, exact, close);
  return {probe.download<kb_u32>(exact, r.exact.size()), probe.download<float>(close, r.close.size())};
}

bool no_opencl_is_excused() {
  const char* excuse = std::getenv("KILOBAND_NO_OPENCL");
  cl_uint platforms = 0;
  return excuse && std::string(excuse) == "1" &&
         (clGetPlatformIDs(0, nullptr, &platforms) != CL_SUCCESS || platforms == 0);
}

void expect_close(const Results& host, const Results& device) {
  for (int column = 0; column < KB_PROBE_CLOSE; ++column) {
    const double tolerance = 16 * 0x1p-23;  // what OpenCL 1.2 grants sin and cos: 4 ulp, log: 3, amplified
    for (kb_u32 i = 0; i < kItems; ++i) {
      const double h = host.close[i * KB_PROBE_CLOSE + column], d = device.close[i * KB_PROBE_CLOSE + column];
      ASSERT_NEAR(h, d, tolerance * std::max(1.0, std::fabs(h))) << "value " << column << " of item " << i;
    }
  }
}

TEST(OpenClDevice, AgreesWithTheHost) {
  if (no_opencl_is_excused()) return;
  const Results host = host_results(), on_device = device_results();
  for (int column = 0; column < KB_PROBE_EXACT; ++column) {
    int different = 0;
    for (kb_u32 i = 0; i < kItems; ++i)
      different += host.exact[i * KB_PROBE_EXACT + column] != on_device.exact[i * KB_PROBE_EXACT + column];
    EXPECT_EQ(different, 0) << "of " << kItems << " items in word " << column;
  }
  expect_close(host, on_device);
}

}  // namespace
}  // namespace kiloband::test
