// What a backend does, in small: allocates, builds, launches, reads. Run with the OpenCL shim by
// shim_test.cpp. With the argument "retry" a lost device is rebuilt and the work repeated once. Prints "done
// SUM" and returns 0, or prints the error and returns 3 DeviceError, 4 DeviceOutOfMemory, 5 DeviceLost, 6
// ProgramBuildError, 70 anything else.
#include <cstdio>
#include <cstring>
#include <numeric>

#include "src_gpu/device/program.hpp"

namespace {

using namespace kiloband;
using namespace kiloband::opencl;

const char* const kText =
    "__kernel void add(__global uint* a, __global const uint* b) { a[get_global_id(0)] += b[0]; }\n";

uint32_t work(DeviceContext& context) {
  DeviceMemory memory(context);
  const Program program =
      build_program(context, {{"kernels/add.cl", kText}}, "kernels/add.cl", ProgramOptions{});
  auto a = memory.allocate<uint32_t>("a", 64);
  const auto b = memory.upload("b", std::vector<uint32_t>{3});
  a.clear();
  Kernel kernel = program.kernel("add");
  kernel.set(a, b).launch(64);
  kernel.launch(64, 32);
  context.finish();
  const std::vector<uint32_t> values = a.download();
  return std::accumulate(values.begin(), values.end(), 0u);
}

uint32_t run(bool retry) {
  DeviceContext context(select_device(std::nullopt));
  try {
    return work(context);
  } catch (const DeviceLost&) {
    if (!retry) throw;
  }
  context.rebuild();
  return work(context);
}

int fail(int code, const std::exception& e) {
  std::printf("%s\n", e.what());
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::printf("done %u\n", run(argc > 1 && std::strcmp(argv[1], "retry") == 0));
    return 0;
  } catch (const DeviceOutOfMemory& e) {
    return fail(4, e);
  } catch (const DeviceLost& e) {
    return fail(5, e);
  } catch (const ProgramBuildError& e) {
    return fail(6, e);
  } catch (const DeviceError& e) {
    return fail(3, e);
  } catch (const std::exception& e) {
    return fail(70, e);
  }
}
