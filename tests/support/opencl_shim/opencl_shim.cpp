// Makes OpenCL fail on purpose. Loaded with LD_PRELOAD before libOpenCL; the environment says what fails:
//
//   KILOBAND_SHIM_FUNCTION  name of one of the functions below; the others work
//   KILOBAND_SHIM_NTH       which of its calls fails, from 1 (default 1)
//   KILOBAND_SHIM_CODE      the code that it gives, a number (default -5, CL_OUT_OF_RESOURCES)
//   KILOBAND_SHIM_REPEAT    1: all later calls fail too
//   KILOBAND_SHIM_THEN      name of a function of which every call gives -4, CL_MEM_OBJECT_ALLOCATION_FAILURE, once the first has failed
//   KILOBAND_SHIM_DEVICE    1: calls of queues of the device count and fail that was the first to have a queue, 2: of
//                           the second ...; functions without a queue never fail then (default: any device)
//   KILOBAND_SHIM_REPORT    file to write at exit: a line "NAME CALLS" per function, then "live_buffers N",
//                           the references to buffers that were not released, "failed N", the calls that
//                           were failed, and "clFinish_I N", the buffers of device memory that were asked for
//                           before its call I
//   KILOBAND_SHIM_PLATFORM  the name that platforms give
//   KILOBAND_SHIM_TYPE      gpu: devices say that they are GPUs
//   KILOBAND_SHIM_GROUP     work-items of a group at most: devices and kernels say so, and launches of larger groups fail
//
// In sanitizer builds run with ASAN_OPTIONS=verify_asan_link_order=0.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <dlfcn.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

namespace {

enum Function {
  kGetPlatformIds,
  kCreateContext,
  kCreateCommandQueue,
  kCreateBuffer,
  kCreateProgramWithSource,
  kCreateProgramWithBinary,
  kBuildProgram,
  kCreateKernel,
  kEnqueueNDRangeKernel,
  kEnqueueReadBuffer,
  kEnqueueWriteBuffer,
  kEnqueueFillBuffer,
  kFinish,
  kFunctionCount
};

constexpr const char* kNames[kFunctionCount] = {"clGetPlatformIDs",
                                                "clCreateContext",
                                                "clCreateCommandQueue",
                                                "clCreateBuffer",
                                                "clCreateProgramWithSource",
                                                "clCreateProgramWithBinary",
                                                "clBuildProgram",
                                                "clCreateKernel",
                                                "clEnqueueNDRangeKernel",
                                                "clEnqueueReadBuffer",
                                                "clEnqueueWriteBuffer",
                                                "clEnqueueFillBuffer",
                                                "clFinish"};

long number_of(const char* variable, long otherwise) {
  const char* text = std::getenv(variable);
  return text && *text ? std::atol(text) : otherwise;
}

/// Counts calls and decides which fail. Reports when the process ends, after the program's own destructors.
struct Plan {
  const char* function = std::getenv("KILOBAND_SHIM_FUNCTION");
  const char* then = std::getenv("KILOBAND_SHIM_THEN");
  const char* report = std::getenv("KILOBAND_SHIM_REPORT");
  long nth = number_of("KILOBAND_SHIM_NTH", 1);
  cl_int code = static_cast<cl_int>(number_of("KILOBAND_SHIM_CODE", CL_OUT_OF_RESOURCES));
  bool repeat = number_of("KILOBAND_SHIM_REPEAT", 0) != 0;
  long device = number_of("KILOBAND_SHIM_DEVICE", 0);  // 0: any
  std::atomic<long> calls[kFunctionCount] = {}, live_buffers{0}, failed{0}, calls_of_device{0},
                    device_buffers{0};
  std::mutex mutex;
  std::vector<cl_device_id> devices;                      // in the order in which they had queues
  std::vector<std::pair<cl_command_queue, long>> queues;  // and their devices' numbers, from 1
  std::vector<long> buffers_before_finish;                // by its calls

  Plan() {
    unsetenv(
        "KILOBAND_SHIM_REPORT");  // or what the process starts, such as a sanitizer's symbolizer, writes it, too
  }

  void note_queue(cl_command_queue queue, cl_device_id its_device) {
    const std::lock_guard lock(mutex);
    long number = 0;
    while (number < static_cast<long>(devices.size()) && devices[number] != its_device) ++number;
    if (number == static_cast<long>(devices.size())) devices.push_back(its_device);
    queues.insert(queues.begin(), {queue, number + 1});  // the newest of an address counts
  }

  long device_of(cl_command_queue queue) {
    const std::lock_guard lock(mutex);
    for (const auto& [known, number] : queues)
      if (known == queue) return number;
    return 0;
  }

  void note_buffers() {
    const std::lock_guard lock(mutex);
    buffers_before_finish.push_back(device_buffers);
  }

  /// The code to give; CL_SUCCESS: call the real function.
  cl_int next(Function called, cl_command_queue queue = nullptr) {
    long call = ++calls[called];
    if (called == kFinish) note_buffers();
    if (then && failed > 0 && std::strcmp(then, kNames[called]) == 0) {
      ++failed;
      return CL_MEM_OBJECT_ALLOCATION_FAILURE;
    }
    if (!function || std::strcmp(function, kNames[called]) != 0) return CL_SUCCESS;
    if (device > 0) {
      if (!queue || device_of(queue) != device) return CL_SUCCESS;
      call = ++calls_of_device;
    }
    if (call < nth || (call > nth && !repeat)) return CL_SUCCESS;
    ++failed;
    return code;
  }

  ~Plan() {
    if (!report || !*report) return;
    std::FILE* file = std::fopen(report, "w");
    if (!file) return;
    for (int i = 0; i < kFunctionCount; ++i) std::fprintf(file, "%s %ld\n", kNames[i], calls[i].load());
    std::fprintf(file, "live_buffers %ld\nfailed %ld\n", live_buffers.load(), failed.load());
    long call = 0;
    for (const long buffers : buffers_before_finish)
      std::fprintf(file, "%s_%ld %ld\n", kNames[kFinish], ++call, buffers);
    std::fclose(file);
  }
};
Plan plan;

/// 0: as the device has it.
size_t largest_group() {
  return static_cast<size_t>(number_of("KILOBAND_SHIM_GROUP", 0));
}

/// The function of libOpenCL that `name` hides.
template <class Pointer>
Pointer real(Pointer, const char* name) {
  void* found = dlsym(RTLD_NEXT, name);
  if (!found) std::abort();
  return reinterpret_cast<Pointer>(found);
}

template <class Object>
Object* refuse(cl_int code, cl_int* error) {
  if (error) *error = code;
  return nullptr;
}

}  // namespace

#define REAL(name) real(&(name), #name)

extern "C" {

cl_int clGetPlatformIDs(cl_uint entries, cl_platform_id* platforms, cl_uint* count) {
  const cl_int code = plan.next(kGetPlatformIds);
  return code ? code : REAL(clGetPlatformIDs)(entries, platforms, count);
}

cl_int clGetPlatformInfo(cl_platform_id platform, cl_platform_info what, size_t size, void* value,
                         size_t* needed) {
  const char* name = std::getenv("KILOBAND_SHIM_PLATFORM");
  if (!name || what != CL_PLATFORM_NAME) return REAL(clGetPlatformInfo)(platform, what, size, value, needed);
  const size_t length = std::strlen(name) + 1;
  if (needed) *needed = length;
  if (value && size < length) return CL_INVALID_VALUE;
  if (value) std::memcpy(value, name, length);
  return CL_SUCCESS;
}

cl_int clGetDeviceInfo(cl_device_id device, cl_device_info what, size_t size, void* value, size_t* needed) {
  const cl_int code = REAL(clGetDeviceInfo)(device, what, size, value, needed);
  if (const size_t group = largest_group();
      code == CL_SUCCESS && group > 0 && value && what == CL_DEVICE_MAX_WORK_GROUP_SIZE)
    std::memcpy(value, &group, sizeof group);
  const char* type = std::getenv("KILOBAND_SHIM_TYPE");
  if (code != CL_SUCCESS || !type || std::strcmp(type, "gpu") != 0 || what != CL_DEVICE_TYPE || !value)
    return code;
  const cl_device_type gpu = CL_DEVICE_TYPE_GPU;
  std::memcpy(value, &gpu, sizeof gpu);
  return code;
}

cl_context clCreateContext(const cl_context_properties* properties, cl_uint count,
                           const cl_device_id* devices,
                           void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* data,
                           cl_int* error) {
  const cl_int code = plan.next(kCreateContext);
  return code ? refuse<_cl_context>(code, error)
              : REAL(clCreateContext)(properties, count, devices, notify, data, error);
}

cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device,
                                      cl_command_queue_properties properties, cl_int* error) {
  if (const cl_int code = plan.next(kCreateCommandQueue)) return refuse<_cl_command_queue>(code, error);
  const cl_command_queue queue = REAL(clCreateCommandQueue)(context, device, properties, error);
  if (queue) plan.note_queue(queue, device);
  return queue;
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error) {
  if (!(flags & CL_MEM_ALLOC_HOST_PTR)) ++plan.device_buffers;
  if (const cl_int code = plan.next(kCreateBuffer)) return refuse<_cl_mem>(code, error);
  const cl_mem buffer = REAL(clCreateBuffer)(context, flags, size, host, error);
  if (buffer) ++plan.live_buffers;
  return buffer;
}

cl_int clRetainMemObject(cl_mem buffer) {
  const cl_int code = REAL(clRetainMemObject)(buffer);
  if (code == CL_SUCCESS) ++plan.live_buffers;
  return code;
}

cl_int clReleaseMemObject(cl_mem buffer) {
  const cl_int code = REAL(clReleaseMemObject)(buffer);
  if (code == CL_SUCCESS) --plan.live_buffers;
  return code;
}

cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** strings,
                                     const size_t* lengths, cl_int* error) {
  const cl_int code = plan.next(kCreateProgramWithSource);
  return code ? refuse<_cl_program>(code, error)
              : REAL(clCreateProgramWithSource)(context, count, strings, lengths, error);
}

cl_program clCreateProgramWithBinary(cl_context context, cl_uint count, const cl_device_id* devices,
                                     const size_t* lengths, const unsigned char** binaries, cl_int* status,
                                     cl_int* error) {
  const cl_int code = plan.next(kCreateProgramWithBinary);
  return code ? refuse<_cl_program>(code, error)
              : REAL(clCreateProgramWithBinary)(context, count, devices, lengths, binaries, status, error);
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void(CL_CALLBACK* notify)(cl_program, void*), void* data) {
  const cl_int code = plan.next(kBuildProgram);
  return code ? code : REAL(clBuildProgram)(program, count, devices, options, notify, data);
}

cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* error) {
  const cl_int code = plan.next(kCreateKernel);
  return code ? refuse<_cl_kernel>(code, error) : REAL(clCreateKernel)(program, name, error);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* global, const size_t* local, cl_uint count,
                              const cl_event* events, cl_event* event) {
  cl_int code = plan.next(kEnqueueNDRangeKernel, queue);
  if (const size_t group = largest_group(); group > 0 && local && *local > group)
    code = CL_INVALID_WORK_GROUP_SIZE;
  return code ? code
              : REAL(clEnqueueNDRangeKernel)(queue, kernel, dimensions, offset, global, local, count, events,
                                             event);
}

cl_int clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what,
                                size_t size, void* value, size_t* needed) {
  const cl_int code = REAL(clGetKernelWorkGroupInfo)(kernel, device, what, size, value, needed);
  if (const size_t group = largest_group();
      code == CL_SUCCESS && group > 0 && value && what == CL_KERNEL_WORK_GROUP_SIZE)
    std::memcpy(value, &group, sizeof group);
  return code;
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                           size_t size, void* to, cl_uint count, const cl_event* events, cl_event* event) {
  const cl_int code = plan.next(kEnqueueReadBuffer, queue);
  return code ? code
              : REAL(clEnqueueReadBuffer)(queue, buffer, blocking, offset, size, to, count, events, event);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                            size_t size, const void* from, cl_uint count, const cl_event* events,
                            cl_event* event) {
  const cl_int code = plan.next(kEnqueueWriteBuffer, queue);
  return code ? code
              : REAL(clEnqueueWriteBuffer)(queue, buffer, blocking, offset, size, from, count, events, event);
}

cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern, size_t pattern_size,
                           size_t offset, size_t size, cl_uint count, const cl_event* events,
                           cl_event* event) {
  const cl_int code = plan.next(kEnqueueFillBuffer, queue);
  return code ? code
              : REAL(clEnqueueFillBuffer)(queue, buffer, pattern, pattern_size, offset, size, count, events,
                                          event);
}

cl_int clFinish(cl_command_queue queue) {
  const cl_int code = plan.next(kFinish, queue);
  const cl_int result =
      REAL(clFinish)(queue);  // also of a failed one: nothing is to run on when the process ends
  return code ? code : result;
}

}  // extern "C"
