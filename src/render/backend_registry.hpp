// Backends by name: the one place that makes them for the program, the validation suite and the tests.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.hpp"
#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"

namespace kiloband {

/// Which backend, and the options of all of them: a backend reads those that concern it.
struct BackendRequest {
  std::string backend = "cpu";            // "cpu", "opencl"; with a method: "opencl:pt"
  std::string isa = "auto";               // cpu: "sse4", "avx2", "avx512"
  int threads = 0;                        // cpu; 0: all processors
  std::optional<std::string> device;      // opencl: index or part of the name
  std::optional<uint64_t> device_memory;  // opencl: bytes
  bool specialised = true;                // opencl: kernels compiled for the scene's features only
  DiagnosticSink sink;
};

/// What is rendered, and with which random numbers.
struct BackendInput {
  std::shared_ptr<const FlatScene> scene;
  DerivedChannels derived;
  SamplingSettings sampling;
};

/// A backend as its library offers it. method: what stands behind the colon, or nothing.
struct BackendEntry {
  std::string name;
  std::vector<std::string> methods;
  std::function<std::unique_ptr<Backend>(const BackendInput& input, const BackendRequest& request,
                                         const std::optional<std::string>& method)>
      make;
};

class BackendRegistry {
 public:
  explicit BackendRegistry(std::vector<BackendEntry> entries) : entries_(std::move(entries)) {}

  /// "cpu", "opencl", "opencl:dpept-batch" ...
  std::vector<std::string> names() const;

  /// throws InputError  no such backend or method; what making the backend throws
  std::unique_ptr<Backend> make(const BackendRequest& request, const BackendInput& input) const;

 private:
  std::vector<BackendEntry> entries_;
};

}  // namespace kiloband
