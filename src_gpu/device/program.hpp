// Programs: kernels of one .cl file, compiled for a device with the macros that specialise them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "src_gpu/device/context.hpp"
#include "src_gpu/device/kernel.hpp"
#include "src_gpu/device/kernel_sources.hpp"

namespace kiloband::opencl {

/// Where a program came from.
enum class ProgramOrigin { kSource, kDisk, kProcess };

class Program {
 public:
  Program(DeviceContext& context, cl::Program program, ProgramOrigin origin)
      : context_(&context), program_(std::move(program)), origin_(origin) {}

  /// A new kernel object, with arguments of its own.
  /// throws std::logic_error  the program has no such kernel
  ///        DeviceError
  Kernel kernel(const std::string& name) const;

  ProgramOrigin origin() const { return origin_; }
  const cl::Program& cl_program() const { return program_; }

 private:
  DeviceContext* context_;
  cl::Program program_;
  ProgramOrigin origin_;
};

struct ProgramOptions {
  std::vector<std::string>
      defines;  // "KB_CHANNELS=64", "KB_SPECIALISED"; what the text does not ask for makes no other program
  bool disk_cache = true;
  uint32_t most_registers = 0;  // of a work-item: register_option()
};

/// The build option by which NVIDIA's compiler keeps to `most` registers per work-item and puts what is left into memory, so that more
/// work-items run side by side. Empty where `extensions` do not have it, or most is 0.
std::string register_option(const std::string& extensions, uint32_t most);

/// Builds kernels/`main` ("path/paths.cl") with -cl-std=CL1.2, without fast-math. Looked for first among the
/// programs of the context, then on disk (program_cache.hpp).
/// throws ProgramBuildError  with the log
///        DeviceError, DeviceLost, DeviceOutOfMemory
Program build_program(DeviceContext& context, const std::string& main,
                      const std::vector<std::string>& defines = {});
Program build_program(DeviceContext& context, const std::string& main, const ProgramOptions& options);

/// The same from sources that are not embedded: `main` is a path in `sources`.
Program build_program(DeviceContext& context, const SourceMap& sources, const std::string& main,
                      const ProgramOptions& options);

}  // namespace kiloband::opencl
