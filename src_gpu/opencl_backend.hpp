// The OpenCL backend: streaming path generation and PT, DPEPT-path or DPEPT-batch evaluation on a device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"
#include "render/backend_registry.hpp"
#include "scene/description/derived_channels.hpp"
#include "src_gpu/path/round_plan.hpp"
#include "src_gpu/tuning/tuning.hpp"

namespace kiloband::opencl {

struct Options {
  /// Index or part of the name; nothing: the first GPU, else what there is. make_backends(): as select_devices().
  std::optional<std::string> device;
  std::optional<uint64_t> device_memory;  // bytes; nothing: default_memory_budget
  std::optional<Method> method;           // nothing: kDefaultMethod
  bool specialised = true;                // kernels compiled for the scene's features only
  bool program_cache = true;              // binaries on disk, where the driver does not keep them itself
  double launch_seconds = 0.5;            // longest launch aimed at: display drivers kill long ones
  Tuning tuning;                          // sizes, before those that are kept for the device
  bool tuned = true;                      // what `kiloband tune` keeps for the device is used
  DiagnosticSink sink;                    // notes on smaller pools and repeated work; may be empty
};

/// throws DeviceError (no device, kernels do not build, out of memory), InputError (no such device)
std::unique_ptr<Backend> make_backend(std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
                                      const SamplingSettings& settings, const Options& options);

/// A backend for every device of select_devices(); what is prepared on the host is there once. A device that
/// fails is left out, with a warning, if another does not.
/// throws as make_backend(): what the last device says where all fail
std::vector<std::unique_ptr<Backend>> make_backends(std::shared_ptr<const FlatScene> scene,
                                                    const DerivedChannels& derived,
                                                    const SamplingSettings& settings, const Options& options);

/// Makes backends of one scene for one device: what is prepared on the host is there once. options.device is not looked at.
using BackendMaker = std::function<std::unique_ptr<Backend>(const Options& options)>;
BackendMaker backend_maker(std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
                           const SamplingSettings& settings, const DeviceInfo& device);

/// "opencl", with the methods of Method.
BackendEntry backend_entry();

}  // namespace kiloband::opencl
