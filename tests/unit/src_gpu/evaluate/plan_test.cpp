// Sizes that follow from the device: paths in flight and of a round, work-groups, which evaluation is built.
#include <gtest/gtest.h>

#include <algorithm>

#include "src_gpu/evaluate/evaluation.hpp"

namespace kiloband::test {
namespace {

using namespace opencl;

constexpr uint64_t kGiB = uint64_t{1} << 30;

TEST(GpuPlan, SlotsAndJobsByMemory) {
  EXPECT_EQ(gpu_slots(0), 1u << 16);
  EXPECT_EQ(gpu_slots(2 * kGiB), 1u << 19);
  EXPECT_EQ(gpu_slots(4 * kGiB), 1u << 20);
  EXPECT_EQ(gpu_slots(8 * kGiB), 1u << 21);
  EXPECT_EQ(gpu_slots(80 * kGiB), 1u << 21);
  EXPECT_EQ(gpu_jobs(0), 1u << 16);
  EXPECT_EQ(gpu_jobs(4 * kGiB), 1u << 21);
  EXPECT_EQ(gpu_jobs(8 * kGiB), 1u << 22);
  EXPECT_EQ(gpu_jobs(80 * kGiB), 1u << 24);
}

/// What pt keeps of every channel for the paths in flight stays within 4 MiB where launches are long enough with that.
TEST(GpuPlan, SlotsOfCpusByTheStateOfTheirPaths) {
  const auto slots = [](uint64_t channels) { return usual_slots(true, kGiB, 2 * sizeof(float) * channels); };
  EXPECT_EQ(slots(0), 1u << 15);  // dpept
  EXPECT_EQ(slots(16), 1u << 15);
  EXPECT_EQ(slots(17), 1u << 14);
  EXPECT_EQ(slots(100), 1u << 12);
  EXPECT_EQ(slots(256), 1u << 11);
  EXPECT_EQ(slots(4096), 1u << 11);
  EXPECT_EQ(usual_slots(false, kGiB, 0), gpu_slots(kGiB));
}

TEST(GpuPlan, WorkGroupsFitTheKernel) {
  EXPECT_EQ(fitting_local_size(128, 256), 128u);
  EXPECT_EQ(fitting_local_size(256, 256), 256u);
  EXPECT_EQ(fitting_local_size(256, 255), 224u);
  EXPECT_EQ(fitting_local_size(64, 40), 32u);
  EXPECT_EQ(fitting_local_size(64, 20), 20u);
}

/// Vertices are staged by work-groups of GPUs that evaluate a path together, and by nothing else.
TEST(GpuPlan, WhoStagesVertices) {
  DeviceInfo device;
  device.max_work_group_size = 1024;
  for (const DeviceType type : {DeviceType::kGpu, DeviceType::kAccelerator, DeviceType::kCpu}) {
    device.type = type;
    for (const Method method : {Method::kDpeptBatch, Method::kDpeptPath, Method::kPt}) {
      const EvaluationShape shape = evaluation_shape(device, method, true, 512);
      const bool staged = type != DeviceType::kCpu && method == Method::kDpeptBatch;
      EXPECT_EQ(shape.staged, staged);
      const std::vector<std::string> defines = shape.defines(0);
      EXPECT_EQ(std::ranges::count(defines, staged ? "KB_STAGED=1" : "KB_STAGED=0"), 1);
      if (staged) {
        EXPECT_EQ(shape.units_per_group, 1u);
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test
