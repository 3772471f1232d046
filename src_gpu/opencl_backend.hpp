// The OpenCL backend: streaming path generation and PT, DPEPT-path or DPEPT-batch evaluation on a device.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/diagnostics.hpp"
#include "render/backend_registry.hpp"
#include "scene/description/derived_channels.hpp"
#include "src_gpu/path/round_plan.hpp"

namespace kiloband {

struct OpenclOptions {
  std::optional<std::string> device;  // index or part of the name; nothing: the first GPU, else what there is
  std::optional<uint64_t> device_memory;  // bytes; nothing: gpu::default_memory_budget
  std::optional<gpu::Method> method;      // nothing: gpu::kDefaultMethod
  bool specialised = true;                // kernels compiled for the scene's features only
  bool program_cache = true;              // binaries on disk
  double launch_seconds = 0.5;            // longest launch aimed at: display drivers kill long ones
  std::optional<uint32_t> pool_slots;     // paths in flight; nothing: what the device gains from
  DiagnosticSink sink;                    // notes on smaller pools and repeated work; may be empty
};

/// throws DeviceError (no device, kernels do not build, out of memory), InputError (no such device)
std::unique_ptr<Backend> make_opencl_backend(std::shared_ptr<const FlatScene> scene,
                                             const DerivedChannels& derived, const SamplingSettings& settings,
                                             const OpenclOptions& options);

/// "opencl", with the methods of gpu::Method.
BackendEntry opencl_backend_entry();

}  // namespace kiloband
