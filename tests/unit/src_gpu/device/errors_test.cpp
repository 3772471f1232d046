// Which exception a code becomes, and what it says.
#include "src_gpu/device/errors.hpp"

#include <gtest/gtest.h>

#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

enum class Kind { kOutOfMemory, kLost, kOther };

Kind kind_of(Phase phase, cl_int code) {
  try {
    throw_device_error({phase, "d", ""}, "clX", code);
  } catch (const DeviceOutOfMemory&) {
    return Kind::kOutOfMemory;
  } catch (const DeviceLost&) {
    return Kind::kLost;
  } catch (const DeviceError&) {
    return Kind::kOther;
  }
}

TEST(Errors, MessageNamesDeviceCallSubjectAndCode) {
  EXPECT_EQ(error_message({Phase::kRun, "H100", "kernel 'shade'"}, "clEnqueueNDRangeKernel", -5),
            "device 'H100': clEnqueueNDRangeKernel of kernel 'shade': CL_OUT_OF_RESOURCES (-5)");
  EXPECT_EQ(error_message({Phase::kRun, "H100", ""}, "clFinish", -36),
            "device 'H100': clFinish: CL_INVALID_COMMAND_QUEUE (-36)");
  EXPECT_STREQ(error_name(-9999), "unknown code");
  EXPECT_STREQ(error_name(CL_INVALID_DEVICE_PARTITION_COUNT), "CL_INVALID_DEVICE_PARTITION_COUNT");
  EXPECT_STREQ(error_name(CL_INVALID_KERNEL_ARGS), "CL_INVALID_KERNEL_ARGS");
}

TEST(Errors, OutOfMemory) {
  for (const Phase phase : {Phase::kSetup, Phase::kAllocate, Phase::kRun}) {
    EXPECT_EQ(kind_of(phase, CL_MEM_OBJECT_ALLOCATION_FAILURE), Kind::kOutOfMemory);
  }
  for (const cl_int code : {CL_INVALID_BUFFER_SIZE, CL_OUT_OF_RESOURCES, CL_OUT_OF_HOST_MEMORY}) {
    EXPECT_EQ(kind_of(Phase::kAllocate, code), Kind::kOutOfMemory) << code;
  }
}

TEST(Errors, Lost) {
  for (const cl_int code : {CL_OUT_OF_RESOURCES, CL_OUT_OF_HOST_MEMORY}) {
    EXPECT_EQ(kind_of(Phase::kRun, code), Kind::kLost) << code;
    EXPECT_EQ(kind_of(Phase::kSetup, code), Kind::kOther) << code;
  }
  for (const cl_int code : {CL_INVALID_COMMAND_QUEUE, CL_INVALID_CONTEXT, CL_DEVICE_NOT_AVAILABLE,
                            CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST, -9999}) {
    EXPECT_EQ(kind_of(Phase::kRun, code), Kind::kLost) << code;
    EXPECT_EQ(kind_of(Phase::kAllocate, code), Kind::kLost) << code;
    EXPECT_EQ(kind_of(Phase::kSetup, code), Kind::kOther) << code;
  }
  EXPECT_EQ(kind_of(Phase::kRun, CL_INVALID_WORK_GROUP_SIZE), Kind::kOther);
}

TEST(Errors, CheckedTranslatesAndReturns) {
  const CallSite site{Phase::kAllocate, "H100", "buffer 'film'"};
  EXPECT_EQ(checked(site, [] { return 7; }), 7);
  const auto fail = [&] { checked(site, []() -> int { throw cl::Error(-4, "clCreateBuffer"); }); };
  EXPECT_EQ(message_of<DeviceOutOfMemory>(fail),
            "device 'H100': clCreateBuffer of buffer 'film': CL_MEM_OBJECT_ALLOCATION_FAILURE (-4)");
}

}  // namespace
}  // namespace kiloband::opencl::test
