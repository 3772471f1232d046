// Runs small probe kernels on the first OpenCL device (PoCL in tests), to compare what kernels/*.clh compute with C++.
#pragma once

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace kiloband::test {

/// What kernels take a whole group of (src_gpu/device/kernel_groups.hpp), here with the probe's buffers.
template <class T>
using ProbeBuffer = cl::Buffer;

/// Sets arguments from `index` on: values, buffers, whole groups of them. Returns the index behind them.
template <class Arg>
cl_uint set_argument(cl::Kernel& kernel, cl_uint index, const Arg& arg) {
  if constexpr (requires { typename Arg::Group; })
    arg.each([&](const auto& one) { kernel.setArg(index++, one); });
  else
    kernel.setArg(index++, arg);
  return index;
}

/// One device, one program built from source text whose includes are rooted at kernels/, src/ and the project.
/// throws std::runtime_error with the build log
class OpenclProbe {
 public:
  explicit OpenclProbe(const std::string& source, const std::string& options = "") {
    setenv("POCL_WORK_GROUP_METHOD", "loops", 0);  // PoCL's default method is 7 to 9 times slower
    std::vector<cl::Platform> platforms;
    cl::Platform::get(&platforms);
    if (platforms.empty()) throw std::runtime_error("no OpenCL platform");
    std::vector<cl::Device> devices;
    platforms.front().getDevices(CL_DEVICE_TYPE_ALL, &devices);
    device = devices.front();
    context = cl::Context(device);
    queue = cl::CommandQueue(context, device);
    program = build(source, options);
  }

  /// One more program on the device, of source text as above, with divisions and roots rounded as in the renderer's programs
  /// (src_gpu/device/program.cpp): correctly where the device can.
  cl::Program build(const std::string& source, const std::string& options) const {
    cl::Program built(context, source);
    const char* named =
        std::getenv("KILOBAND_SOURCES");  // of a program that is away from its sources (docs/portable.md)
    const std::string root = named ? named : KILOBAND_SOURCE_DIR;
    const std::string flags = "-cl-std=CL1.2 -I" + root + "/kernels -I" + root + "/src -I" + root + " " +
                              (rounds_correctly() ? "-cl-fp32-correctly-rounded-divide-sqrt " : "") + options;
    try {
      built.build(flags.c_str());
    } catch (const cl::Error&) {
      throw std::runtime_error("kernel build:\n" + built.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device));
    }
    return built;
  }

  /// Whether divisions and roots of the programs are correctly rounded; else within 2.5 and 3 units of the last place (OpenCL 1.2, 7.4).
  bool rounds_correctly() const {
    return (device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
  }

  /// A device copy of `values` (of one byte if there are none).
  template <class T>
  cl::Buffer upload(const std::vector<T>& values) {
    const std::size_t bytes = std::max<std::size_t>(values.size() * sizeof(T), 1);
    cl::Buffer buffer(context, CL_MEM_READ_WRITE, bytes);
    if (!values.empty())
      queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size() * sizeof(T), values.data());
    return buffer;
  }
  template <class T>
  std::vector<T> download(const cl::Buffer& buffer, std::size_t count) {
    std::vector<T> values(count);
    queue.enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(T), values.data());
    return values;
  }
  /// Runs `name` over `items` work-items with the arguments in order.
  template <class... Args>
  void run(const char* name, std::size_t items, const Args&... args) {
    cl::Kernel kernel(program, name);
    cl_uint index = 0;
    ((index = set_argument(kernel, index, args)), ...);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NullRange);
    queue.finish();
  }

  cl::Device device;
  cl::Context context;
  cl::CommandQueue queue;
  cl::Program program;
};

}  // namespace kiloband::test
