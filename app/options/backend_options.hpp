// Which backend renders, and on what: options that the subcommands share.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "base/diagnostics.hpp"
#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"

namespace kiloband {

/// "4GiB", "512MiB", "2GB", "1e9" or plain bytes. option: its name, for messages.
/// throws InputError
uint64_t parse_bytes(const std::string& option, const std::string& text);

/// With `auto` an option that only one backend has chooses that backend; else a GPU is taken if there is one.
struct BackendOptions {
  std::string backend = "auto";
  std::optional<std::string> isa, device, device_memory, method;
  std::optional<int> threads;

  /// with_method: --method too, for commands that evaluate paths
  void add_to(CLI::App& command, bool with_method = true);
  /// "cpu", "opencl" or "cpu+opencl".
  /// throws InputError  options that do not apply
  std::string resolve() const;
};

/// throws InputError, DeviceError
std::unique_ptr<Backend> make_backend(const BackendOptions& options, std::shared_ptr<const FlatScene> scene,
                                      const DerivedChannels& derived, const SamplingSettings& sampling,
                                      const DiagnosticSink& sink);

}  // namespace kiloband
