// The CPU backend: OpenMP over blocks of pixels; paths by Embree, evaluation by SIMD over channels.
#pragma once

#include <memory>
#include <string>

#include "render/backend_registry.hpp"
#include "scene/description/derived_channels.hpp"
#include "src_cpu/lanes/isa.hpp"

namespace kiloband::cpu {

struct Options {
  Isa isa = Isa::kAuto;
  int threads = 0;  // 0: all processors
};

/// As the operating system calls it.
std::string processor_name();

/// Same seed, settings and instruction set: same bits, for any number of threads.
/// throws DeviceError  no such instruction set here, Embree failed
std::unique_ptr<Backend> make_backend(std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
                                      const SamplingSettings& settings, const Options& options);

/// "cpu".
BackendEntry backend_entry();

}  // namespace kiloband::cpu
