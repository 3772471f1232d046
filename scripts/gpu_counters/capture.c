/* Preloaded (LD_PRELOAD) into a program that uses OpenCL: writes one launch of one kernel to files, whole, so that it can be repeated elsewhere
 * (replay.py). Environment:
 *   CAPTURE_KERNEL  its name
 *   CAPTURE_LAUNCH  which of its launches, counted from 0 (the default)
 *   CAPTURE_FOLDER  where: launch.json (sizes, arguments), program (as the driver gives it; PTX on NVIDIA), argument-NUMBER (memory as it was)
 * A launch that cannot be written ends the program with exit code 70. Arguments are remembered for one thread at a time. */
#define _GNU_SOURCE
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REAL(function) ((__typeof__(&function))dlsym(RTLD_NEXT, #function))
enum { kMostArguments = 128, kMostBytes = 64 };

typedef struct {
  bool set;
  size_t size;
  bool is_local; /* local memory of `size` bytes */
  unsigned char value[kMostBytes];
} Argument;

static cl_kernel captured; /* the kernel of that name whose arguments are remembered */
static Argument arguments[kMostArguments];

static void fail(const char* what) {
  fprintf(stderr, "capture: %s\n", what);
  exit(70);
}

static bool is_wanted(cl_kernel kernel) {
  const char* wanted = getenv("CAPTURE_KERNEL");
  char name[256] = "";
  return wanted && clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, NULL) == CL_SUCCESS &&
         strcmp(name, wanted) == 0;
}

cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t size, const void* value) {
  if (is_wanted(kernel)) {
    if (captured != kernel) memset(arguments, 0, sizeof arguments);
    captured = kernel;
    if (index >= kMostArguments || (value && size > kMostBytes)) fail("an argument too many, or too large");
    Argument* a = &arguments[index];
    a->set = true;
    a->size = size;
    a->is_local = value == NULL;
    if (value) memcpy(a->value, value, size);
  }
  return REAL(clSetKernelArg)(kernel, index, size, value);
}

static FILE* open_file(const char* name, int number) {
  const char* folder = getenv("CAPTURE_FOLDER");
  char path[4096];
  if (!folder) fail("no CAPTURE_FOLDER");
  if (number >= 0)
    snprintf(path, sizeof path, "%s/%s-%d", folder, name, number);
  else
    snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE* file = fopen(path, "wb");
  if (!file) fail(path);
  return file;
}

static void write_file(const char* name, int number, const void* bytes, size_t size) {
  FILE* file = open_file(name, number);
  if (fwrite(bytes, 1, size, file) != size || fclose(file) != 0) fail("a file could not be written");
}

static void* allocate(size_t size) {
  void* bytes = malloc(size ? size : 1);
  if (!bytes) fail("no memory");
  return bytes;
}

static void write_program(cl_kernel kernel) {
  cl_program program;
  size_t size = 0;
  if (clGetKernelInfo(kernel, CL_KERNEL_PROGRAM, sizeof program, &program, NULL) != CL_SUCCESS ||
      clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, NULL) != CL_SUCCESS || size == 0)
    fail("the driver gives no program (of one device)");
  unsigned char* binary = allocate(size);
  if (clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof binary, &binary, NULL) != CL_SUCCESS) fail("no program");
  write_file("program", -1, binary, size);
  free(binary);
}

/* Is the argument a buffer? Where the driver does not tell (no -cl-kernel-arg-info), what has the size of a handle is taken for one. */
static bool is_buffer(cl_kernel kernel, cl_uint index, size_t size) {
  cl_kernel_arg_address_qualifier space;
  if (size != sizeof(cl_mem)) return false;
  if (clGetKernelArgInfo(kernel, index, CL_KERNEL_ARG_ADDRESS_QUALIFIER, sizeof space, &space, NULL) != CL_SUCCESS)
    return true;
  return space == CL_KERNEL_ARG_ADDRESS_GLOBAL || space == CL_KERNEL_ARG_ADDRESS_CONSTANT;
}

/* The bytes of a buffer to argument-NUMBER; one that several arguments name is written once for each. */
static void write_buffer(FILE* list, cl_command_queue queue, cl_mem buffer, cl_uint index) {
  size_t size = 0;
  if (clGetMemObjectInfo(buffer, CL_MEM_SIZE, sizeof size, &size, NULL) != CL_SUCCESS) fail("no size of a buffer");
  void* bytes = allocate(size);
  if (clEnqueueReadBuffer(queue, buffer, CL_TRUE, 0, size, bytes, 0, NULL, NULL) != CL_SUCCESS)
    fail("a buffer could not be read");
  write_file("argument", (int)index, bytes, size);
  free(bytes);
  fprintf(list, "{\"kind\": \"buffer\", \"bytes\": %zu, \"handle\": \"%p\"}", size, (void*)buffer);
}

static void write_argument(FILE* list, cl_command_queue queue, cl_kernel kernel, cl_uint index) {
  const Argument* a = &arguments[index];
  cl_mem buffer = NULL;
  if (!a->set) fail("an argument that was set before capture began");
  if (a->is_local) {
    fprintf(list, "{\"kind\": \"local\", \"bytes\": %zu}", a->size);
  } else if (is_buffer(kernel, index, a->size)) {
    memcpy(&buffer, a->value, sizeof buffer);
    if (buffer)
      write_buffer(list, queue, buffer, index);
    else
      fprintf(list, "{\"kind\": \"null\"}");
  } else {
    fprintf(list, "{\"kind\": \"value\", \"hex\": \"");
    for (size_t i = 0; i < a->size; ++i) fprintf(list, "%02x", a->value[i]);
    fprintf(list, "\"}");
  }
}

static void write_launch(cl_command_queue queue, cl_kernel kernel, const size_t* global, const size_t* local) {
  cl_uint count = 0;
  if (clFinish(queue) != CL_SUCCESS || clGetKernelInfo(kernel, CL_KERNEL_NUM_ARGS, sizeof count, &count, NULL) != CL_SUCCESS)
    fail("the queue does not finish");
  write_program(kernel);
  FILE* list = open_file("launch.json", -1);
  fprintf(list, "{\"kernel\": \"%s\", \"global\": %zu, \"local\": %zu, \"arguments\": [", getenv("CAPTURE_KERNEL"), global[0],
          local[0]);
  for (cl_uint i = 0; i < count; ++i) {
    fprintf(list, "%s\n  ", i ? "," : "");
    write_argument(list, queue, kernel, i);
  }
  fprintf(list, "]}\n");
  if (fclose(list) != 0) fail("launch.json could not be written");
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                              const size_t* global, const size_t* local, cl_uint events, const cl_event* wait,
                              cl_event* event) {
  static long launches = 0;
  const char* wanted = getenv("CAPTURE_LAUNCH");
  if (is_wanted(kernel) && launches++ == (wanted ? atol(wanted) : 0)) {
    if (dimensions != 1 || !local || (offset && offset[0] != 0)) fail("only launches of one dimension, without offset");
    if (kernel != captured) fail("several kernels of that name in turns");
    write_launch(queue, kernel, global, local);
  }
  return REAL(clEnqueueNDRangeKernel)(queue, kernel, dimensions, offset, global, local, events, wait, event);
}
