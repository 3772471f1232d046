#include "src_gpu/device/program.hpp"

#include <algorithm>
#include <stdexcept>

#include "src_gpu/device/pocl_cache.hpp"
#include "src_gpu/device/program_cache.hpp"

namespace kiloband::opencl {
namespace {

/// No warnings, which a test asks for (KernelSyntax) and PoCL counts on the user's terminal: clang has some about vectors wider than the
/// processor's (-Wpsabi), in functions that are called within one program alone.
/// No fast-math, ever: results are compared with the CPU's. Devices that can round divisions and roots
/// correctly are asked to; the others may be off by 2.5 and 3 ulp (OpenCL 1.2, 7.4).
/// Defines that the text does not ask for are left out: programs that differ in nothing else are one.
std::string build_options(const DeviceContext& context, const ProgramOptions& options,
                          const std::string& source) {
  std::string text = "-cl-std=CL1.2 -w";
  const cl_device_fp_config config = checked(
      context.site(Phase::kSetup), [&] { return context.cl_device().getInfo<CL_DEVICE_SINGLE_FP_CONFIG>(); });
  if (config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) text += " -cl-fp32-correctly-rounded-divide-sqrt";
  const std::string extensions = checked(context.site(Phase::kSetup),
                                         [&] { return context.cl_device().getInfo<CL_DEVICE_EXTENSIONS>(); });
  text += register_option(extensions, options.most_registers);
  for (const std::string& define : options.defines) {
    if (asks_for(source, std::string_view(define).substr(0, define.find('=')))) text += " -D" + define;
  }
  return text;
}

/// Not Program::build of the bindings: it asks for the log first, and where that fails,
/// its error hides the real one.
cl_int build(const cl::Program& program, const cl::Device& device, const std::string& options) {
  return clBuildProgram(program(), 1, &device(), options.c_str(), nullptr, nullptr);
}

/// Nothing where the driver refuses the binary.
std::optional<cl::Program> from_binary(const DeviceContext& context, std::vector<unsigned char> binary,
                                       const std::string& options) {
  try {
    cl::Program program(context.context(), {context.cl_device()}, cl::Program::Binaries{std::move(binary)});
    if (build(program, context.cl_device(), options) != CL_SUCCESS) return std::nullopt;
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;
  }
}

std::string build_log(const cl::Program& program, const cl::Device& device) {
  try {
    std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    log.erase(std::min(log.find('\0'), log.find_last_not_of("\n") + 1));  // what drivers end it with
    return log;
  } catch (const cl::Error&) {
    return "the driver gives no log";
  }
}

cl::Program from_source(const DeviceContext& context, const std::string& main, const std::string& source,
                        const std::string& options) {
  const CallSite site = context.site(Phase::kSetup, "'" + main + "'");
  cl::Program program = checked(site, [&] { return cl::Program(context.context(), source); });
  const cl_int code = build(program, context.cl_device(), options);
  if (code == CL_BUILD_PROGRAM_FAILURE || code == CL_INVALID_BUILD_OPTIONS) {
    throw ProgramBuildError(error_message(site, "clBuildProgram", code) + " with " + options + "\n" +
                            build_log(program, context.cl_device()) +
                            (context.device().is_pocl() ? pocl_build_hint() : ""));
  }
  if (code != CL_SUCCESS) throw_device_error(site, "clBuildProgram", code);
  return program;
}

void save_binary(DeviceContext& context, const ProgramCache& cache, const std::string& key,
                 const cl::Program& program) {
  try {
    const cl::Program::Binaries binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.size() != 1) return;
    if (const std::string problem = cache.save(key, binaries.front()); !problem.empty())
      context.note_cache_problem(problem);
  } catch (const cl::Error&) {
    return;  // a driver without binaries: the program is built from source each time
  }
}

}  // namespace

std::string register_option(const std::string& extensions, uint32_t most) {
  const bool known = (" " + extensions + " ").find(" cl_nv_compiler_options ") != std::string::npos;
  return known && most > 0 ? " -cl-nv-maxrregcount=" + std::to_string(most) : "";
}

Kernel Program::kernel(const std::string& name) const {
  try {
    return Kernel(*context_, cl::Kernel(program_, name.c_str()), name);
  } catch (const cl::Error& e) {
    const CallSite site = context_->site(Phase::kSetup, "kernel '" + name + "'");
    if (e.err() == CL_INVALID_KERNEL_NAME) throw std::logic_error(error_message(site, e.what(), e.err()));
    throw_device_error(site, e.what(), e.err());
  }
}

Program build_program(DeviceContext& context, const SourceMap& sources, const std::string& main,
                      const ProgramOptions& options) {
  const std::string source = assemble_source(sources, main);
  const std::string flags = build_options(context, options, source);
  const std::string key = ProgramCache::key(source, flags, context.device());
  if (auto known = context.programs().find(key))
    return Program(context, std::move(*known), ProgramOrigin::kProcess);

  const ProgramCache cache = options.disk_cache ? ProgramCache::of_user() : ProgramCache({});
  if (auto binary = cache.load(key)) {
    if (auto program = from_binary(context, std::move(*binary), flags)) {
      context.programs().keep(key, *program);
      return Program(context, *program, ProgramOrigin::kDisk);
    }
  }
  const cl::Program program = from_source(context, main, source, flags);
  if (options.disk_cache) save_binary(context, cache, key, program);
  context.programs().keep(key, program);
  return Program(context, program, ProgramOrigin::kSource);
}

Program build_program(DeviceContext& context, const std::string& main, const ProgramOptions& options) {
  return build_program(context, embedded_sources(), "kernels/" + main, options);
}

Program build_program(DeviceContext& context, const std::string& main,
                      const std::vector<std::string>& defines) {
  return build_program(context, main, ProgramOptions{defines, true});
}

}  // namespace kiloband::opencl
