#include "validation/speed/device_limits.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "src_gpu/device/kernel.hpp"
#include "src_gpu/device/memory.hpp"
#include "src_gpu/device/program.hpp"

namespace kiloband::speed {
namespace {

constexpr int kAttempts = 5;

bool is_cpu(const opencl::DeviceContext& context) {
  return context.device().type == opencl::DeviceType::kCpu;
}

uint64_t threads_of(const opencl::DeviceContext& context) {
  return is_cpu(context) ? 64 : 1u << 18;
}

}  // namespace

double triad_bandwidth(opencl::DeviceContext& context, uint64_t bytes) {
  // Processors have their vectors within a work-item; lanes of GPUs are to read neighbouring 16 bytes.
  const uint32_t width = is_cpu(context) ? 16 : 4;
  const opencl::SourceMap source{
      {"kernels/triad.cl",
       "#define REALS float" + std::to_string(width) +
           "\n"
           "__kernel void triad(__global REALS* restrict a, __global const REALS* restrict b,\n"
           "  __global const REALS* restrict c, uint repeats, uint items) {\n"
           "  for (uint r = 0; r < repeats; ++r)\n"
           "    for (uint i = get_global_id(0); i < items; i += get_global_size(0))\n"
           "      a[i] = b[i] + 3.0f * c[i];\n}\n"}};
  opencl::Kernel kernel = opencl::build_program(context, source, "kernels/triad.cl", {}).kernel("triad");
  opencl::DeviceMemory memory(context, uint64_t{1} << 33);
  const uint64_t item_bytes = 3 * sizeof(float) * width;
  const uint64_t items = std::max<uint64_t>(bytes / item_bytes, 64);
  const auto floats = items * width;
  const std::vector<float> ones(floats, 1.0f);
  opencl::DeviceBuffer<float> a = memory.upload("a", ones), b = memory.upload("b", ones),
                              c = memory.upload("c", ones);
  const uint64_t threads = std::min<uint64_t>(items, threads_of(context));
  const auto repeats = static_cast<uint32_t>(
      std::max<uint64_t>((uint64_t{1} << (is_cpu(context) ? 29 : 33)) / (items * item_bytes), 1));
  kernel.set(a, b, c, repeats, static_cast<uint32_t>(items));
  double best = 0;
  for (int i = 0; i < kAttempts; ++i) {
    const double seconds = kernel.launch_timed(threads);
    best = std::max(best, static_cast<double>(items * item_bytes) * repeats / seconds);
  }
  return best;
}

double peak_flops(opencl::DeviceContext& context) {
  const opencl::SourceMap source{
      {"kernels/peak.cl",
       "__kernel void peak(__global float16* restrict out, uint repeats, float factor) {\n"
       "  float16 a = factor, b = a + 1.0f, c = a + 2.0f, d = a + 3.0f;\n"
       "  float16 e = a + 4.0f, f = a + 5.0f, g = a + 6.0f, h = a + 7.0f;\n"
       "  const float16 s = factor;\n"
       "  for (uint r = 0; r < repeats; ++r) {\n"
       "    a = fma(a, s, s); b = fma(b, s, s); c = fma(c, s, s); d = fma(d, s, s);\n"
       "    e = fma(e, s, s); f = fma(f, s, s); g = fma(g, s, s); h = fma(h, s, s);\n"
       "  }\n"
       "  out[get_global_id(0)] = a + b + c + d + e + f + g + h;\n}\n"}};
  opencl::Kernel kernel = opencl::build_program(context, source, "kernels/peak.cl", {}).kernel("peak");
  opencl::DeviceMemory memory(context, uint64_t{1} << 30);
  const uint64_t threads = threads_of(context);
  opencl::DeviceBuffer<float> out = memory.allocate<float>("out", threads * 16);
  const auto repeats = static_cast<uint32_t>((uint64_t{1} << (is_cpu(context) ? 24 : 27)) / threads);
  kernel.set(out, repeats, 0.5f);
  double best = 0;
  for (int i = 0; i < kAttempts; ++i) {
    const double seconds = kernel.launch_timed(threads);
    best = std::max(best, static_cast<double>(threads) * repeats * 8 * 16 * 2 / seconds);
  }
  return best;
}

}  // namespace kiloband::speed
