// The dual-language headers on an OpenCL device (PoCL in automated runs) against the same code on the host:
// bit for bit where only integers and + - * / sqrt occur, within a few ulp where the device has its
// own sin, exp, erf.
//
// Without an OpenCL device the test fails; the environment variable KILOBAND_NO_OPENCL=1 says
// that this is known.
#include <CL/cl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "base/temporary_folder.hpp"
#include "tests/unit/shared/opencl_probe.h"

namespace {

constexpr kb_u32 kItems = 1 << 14;

const char* const kSource = R"(
#include "tests/unit/shared/opencl_probe.h"
__kernel void probe(__global uint* exact, __global float* close) {
  kb_probe_item((uint)get_global_id(0), exact, close);
}
)";

struct Results {
  std::vector<kb_u32> exact = std::vector<kb_u32>(std::size_t{kItems} * KB_PROBE_EXACT);
  std::vector<float> close = std::vector<float>(std::size_t{kItems} * KB_PROBE_CLOSE);
};

Results host_results() {
  Results r;
  for (kb_u32 i = 0; i < kItems; ++i) kb_probe_item(i, r.exact.data(), r.close.data());
  return r;
}

// PoCL reads these when it is first used. A cache of its own keeps stale builds and other runs out.
class OpenClDevice : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    cache_ = kiloband::make_temporary_folder("kiloband_pocl");
    setenv("POCL_CACHE_DIR", cache_.c_str(), 1);
    setenv("POCL_WORK_GROUP_METHOD", "loops", 0);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(cache_); }

  // A device that rounds divisions and square roots correctly when asked to, as the bit-for-bit part needs.
  cl_device_id find_device() {
    cl_uint count = 0;
    if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS) return nullptr;
    std::vector<cl_platform_id> platforms(count);
    clGetPlatformIDs(count, platforms.data(), nullptr);
    for (cl_platform_id platform : platforms) {
      cl_device_id device = nullptr;
      if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr) != CL_SUCCESS) continue;
      cl_device_fp_config config = 0;
      clGetDeviceInfo(device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof config, &config, nullptr);
      if (config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) return device;
    }
    return nullptr;
  }

  static std::string build_log(cl_program program, cl_device_id device) {
    std::size_t size = 0;
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    return log;
  }

  // Runs the probe; what fails is reported and leaves the results zero.
  static Results device_results(cl_device_id device) {
    Results r;
    cl_int status = CL_SUCCESS;
    cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status);
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, &status);
    const char* source = kSource;
    cl_program program = clCreateProgramWithSource(context, 1, &source, nullptr, &status);
    const char* options =
        "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt -Werror -I " KILOBAND_SOURCE_DIR
        "/src -I " KILOBAND_SOURCE_DIR;
    status = clBuildProgram(program, 1, &device, options, nullptr, nullptr);
    EXPECT_EQ(status, CL_SUCCESS) << build_log(program, device);
    if (status == CL_SUCCESS) run(context, queue, program, r);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    return r;
  }

  static void run(cl_context context, cl_command_queue queue, cl_program program, Results& r) {
    const auto bytes = [](const auto& v) { return v.size() * sizeof v[0]; };
    cl_int status[3] = {};
    cl_mem exact = clCreateBuffer(context, CL_MEM_WRITE_ONLY, bytes(r.exact), nullptr, &status[0]);
    cl_mem close = clCreateBuffer(context, CL_MEM_WRITE_ONLY, bytes(r.close), nullptr, &status[1]);
    cl_kernel kernel = clCreateKernel(program, "probe", &status[2]);
    for (const cl_int s : status) ASSERT_EQ(s, CL_SUCCESS);
    clSetKernelArg(kernel, 0, sizeof exact, &exact);
    clSetKernelArg(kernel, 1, sizeof close, &close);
    const std::size_t global = kItems, local = 64;
    EXPECT_EQ(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &global, &local, 0, nullptr, nullptr),
              CL_SUCCESS);
    EXPECT_EQ(
        clEnqueueReadBuffer(queue, exact, CL_TRUE, 0, bytes(r.exact), r.exact.data(), 0, nullptr, nullptr),
        CL_SUCCESS);
    EXPECT_EQ(
        clEnqueueReadBuffer(queue, close, CL_TRUE, 0, bytes(r.close), r.close.data(), 0, nullptr, nullptr),
        CL_SUCCESS);
    clReleaseKernel(kernel);
    for (cl_mem buffer : {exact, close}) clReleaseMemObject(buffer);
  }

  static inline std::filesystem::path cache_;
};

bool opencl_is_excused() {
  const char* value = std::getenv("KILOBAND_NO_OPENCL");
  return value != nullptr && std::strcmp(value, "1") == 0;
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

TEST_F(OpenClDevice, AgreesWithTheHost) {
  cl_device_id device = find_device();
  if (device == nullptr && opencl_is_excused()) return;
  ASSERT_NE(device, nullptr)
      << "no OpenCL device with correctly rounded division was found; install pocl-opencl-icd, "
         "or set KILOBAND_NO_OPENCL=1 to do without this test";
  const Results host = host_results(), on_device = device_results(device);
  for (int column = 0; column < KB_PROBE_EXACT; ++column) {
    int different = 0;
    for (kb_u32 i = 0; i < kItems; ++i)
      different += host.exact[i * KB_PROBE_EXACT + column] != on_device.exact[i * KB_PROBE_EXACT + column];
    EXPECT_EQ(different, 0) << "of " << kItems << " items in word " << column;
  }
  expect_close(host, on_device);
}

}  // namespace
