// Failures of OpenCL as exceptions of ours: they name the call, the code by name and number,
// the kernel and the device.
#pragma once

#include <string>
#include <utility>

#include "base/error.hpp"
#include "src_gpu/device/opencl.hpp"

namespace kiloband::opencl {

/// Memory of the device (or the budget) is used up. The caller may try again with less.
class DeviceOutOfMemory : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// The context is dead: every object made from it must be made anew (DeviceContext::rebuild) and the work
/// since the last result repeated. Drivers report crashed kernels, watchdogs and removed devices like this.
class DeviceLost : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// The kernels do not compile, or the driver cannot link them. what() has the build log with files and lines.
class ProgramBuildError : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// What was being done; the same code means different things at different calls.
enum class Phase {
  kSetup,     // queries, contexts, queues, programs, kernel objects, arguments
  kAllocate,  // creating a buffer and touching it for the first time
  kRun,       // launches, transfers, finish
};

struct CallSite {
  Phase phase = Phase::kSetup;
  std::string device;   // its name
  std::string subject;  // "kernel 'shade'", "buffer 'film'", or empty
};

/// "CL_OUT_OF_RESOURCES"; "unknown code" for what OpenCL 1.2 does not know.
const char* error_name(cl_int code);

/// "device 'NAME': clEnqueueReadBuffer of buffer 'film': CL_OUT_OF_RESOURCES (-5)"
std::string error_message(const CallSite& site, const std::string& call, cl_int code);

/// throws DeviceOutOfMemory  CL_MEM_OBJECT_ALLOCATION_FAILURE at any call; CL_INVALID_BUFFER_SIZE,
///                           CL_OUT_OF_RESOURCES and CL_OUT_OF_HOST_MEMORY while allocating
///        DeviceLost         CL_OUT_OF_RESOURCES, CL_OUT_OF_HOST_MEMORY, CL_INVALID_COMMAND_QUEUE,
///                           CL_INVALID_CONTEXT, CL_DEVICE_NOT_AVAILABLE, a failed event or a code that
///                           OpenCL does not define, while running (the last four also while allocating)
///        DeviceError        anything else
[[noreturn]] void throw_device_error(const CallSite& site, const std::string& call, cl_int code);

/// Runs `call`; a cl::Error that leaves it becomes one of the exceptions above.
template <class Call>
decltype(auto) checked(const CallSite& site, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (const cl::Error& e) {
    throw_device_error(site, e.what() ? e.what() : "OpenCL", e.err());
  }
}

}  // namespace kiloband::opencl
