// Backends by name: the one place that makes them for the program, the validation suite and the tests.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostics.hpp"
#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"

namespace kiloband {

/// Which backend, and the options of all of them: a backend reads those that concern it.
struct BackendRequest {
  std::string backend = "cpu";        // "cpu", "opencl"; with a method: "opencl:pt"; several: "cpu+opencl:pt"
  std::string isa = "auto";           // cpu: "sse4", "avx2", "avx512"
  int threads = 0;                    // cpu; 0: all processors
  int reserved_threads = 0;           // cpu: processors that others need, where `threads` is 0
  std::optional<std::string> device;  // opencl: index or part of the name, or several
  std::optional<uint64_t> device_memory;  // opencl: bytes, of each device
  bool specialised = true;                // opencl: kernels compiled for the scene's features only
  DiagnosticSink sink;
};

/// What is rendered, and with which random numbers.
struct BackendInput {
  std::shared_ptr<const FlatScene> scene;
  DerivedChannels derived;
  SamplingSettings sampling;
};

/// A backend as its library offers it: one for each device that is asked for. method: what stands behind the colon, or
/// nothing.
struct BackendEntry {
  std::string name;
  std::vector<std::string> methods;
  std::function<std::vector<std::unique_ptr<Backend>>(
      const BackendInput& input, const BackendRequest& request, const std::optional<std::string>& method)>
      make;
};

class BackendRegistry {
 public:
  explicit BackendRegistry(std::vector<BackendEntry> entries) : entries_(std::move(entries)) {}

  /// "cpu", "opencl", "opencl:dpept-batch" ...
  std::vector<std::string> names() const;

  /// Several devices or backends become a group (devices/device_group.hpp). The CPU backend then leaves a processor to
  /// each other device, unless the request says how many threads it has.
  /// throws InputError  no such backend or method, or one that is named twice; what making the backend throws
  std::unique_ptr<Backend> make(const BackendRequest& request, const BackendInput& input) const;

 private:
  using Named = std::pair<const BackendEntry*, std::optional<std::string>>;  // with its method
  Named find(const std::string& name) const;
  std::vector<Named> find_all(const std::string& names) const;

  std::vector<BackendEntry> entries_;
};

}  // namespace kiloband
