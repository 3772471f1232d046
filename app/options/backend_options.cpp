#include "app/options/backend_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/options/whole_numbers.hpp"
#include "base/error.hpp"
#include "render/backend_registry.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/device/device.hpp"
#include "src_gpu/opencl_backend.hpp"

namespace kiloband {
namespace {

constexpr const char* kBothBackends = "cpu+opencl";

/// A real GPU; a loader or driver that fails counts as none.
bool has_gpu() {
  try {
    const auto devices = opencl::list_devices();
    return std::ranges::any_of(devices, [](const auto& d) { return d.type == opencl::DeviceType::kGpu; });
  } catch (const DeviceError&) {
    return false;
  }
}

/// As the registry calls it.
std::string backend_name(const std::string& name, const std::optional<std::string>& method) {
  const bool opencl = name.ends_with("opencl");  // alone, or behind the CPU
  return opencl && method ? name + ":" + *method : name;
}

/// The first option of a backend that was given, or null.
const char* cpu_option(const BackendOptions& o) {
  return o.isa ? "--isa" : o.threads ? "--threads" : nullptr;
}
const char* opencl_option(const BackendOptions& o) {
  return o.device ? "--device" : o.device_memory ? "--device-memory" : o.method ? "--method" : nullptr;
}

}  // namespace

uint64_t parse_bytes(const std::string& option, const std::string& text) {
  static const std::map<std::string, double> kUnits{
      {"", 1},     {"B", 1},        {"kB", 1e3},        {"MB", 1e6},
      {"GB", 1e9}, {"KiB", 1024.0}, {"MiB", 1048576.0}, {"GiB", 1073741824.0}};
  std::size_t end = 0;
  double value = 0;
  try {
    value = std::stod(text, &end);
  } catch (const std::exception&) {
  }
  const auto unit = kUnits.find(text.substr(end));
  if (end == 0 || unit == kUnits.end() || !(value * unit->second >= 1) || !(value * unit->second < 1e18))
    throw InputError(option + " " + text + ": must be an amount of memory such as 4GiB, 512MiB or 2e9");
  return static_cast<uint64_t>(value * unit->second);
}

void BackendOptions::add_to(CLI::App& command, bool with_method) {
  command
      .add_option("--backend", backend,
                  "auto (a GPU if there is one, else the CPU), cpu, opencl, or cpu+opencl: both together")
      ->check(CLI::IsMember({"auto", "cpu", "opencl", kBothBackends}))
      ->capture_default_str();
  command.add_option("--threads", threads, "cpu: threads (0: all)")->transform(whole_numbers(0, 4096));
  command.add_option("--isa", isa, "cpu: instruction set (default auto)")
      ->check(CLI::IsMember({"auto", "sse4", "avx2", "avx512"}));
  command.add_option(
      "--device", device,
      "opencl: index or part of the name, as `kiloband devices` lists them; several, which render "
      "together: 0,1 or all; 0/2: both halves of device 0");
  command.add_option("--device-memory", device_memory,
                     "opencl: memory to use at most, of each device, such as 4GiB");
  if (!with_method) return;
  command
      .add_option("--method", method,
                  "opencl: how paths are evaluated (default dpept-batch); all give the same image")
      ->check(CLI::IsMember({"dpept-batch", "dpept-path", "pt"}));
}

std::string BackendOptions::resolve() const {
  const char* cpu = cpu_option(*this);
  const char* opencl = opencl_option(*this);
  if (backend == "cpu" && opencl) throw InputError(fmt::format("{} does not apply to --backend cpu", opencl));
  if (backend == "opencl" && cpu) throw InputError(fmt::format("{} does not apply to --backend opencl", cpu));
  if (backend != "auto") return backend;
  if (cpu && opencl)
    throw InputError(
        fmt::format("{} is for the CPU backend, {} for the OpenCL one: choose with --backend", cpu, opencl));
  if (opencl) return "opencl";
  return !cpu && has_gpu() ? "opencl" : "cpu";
}

std::unique_ptr<Backend> make_backend(const BackendOptions& options, std::shared_ptr<const FlatScene> scene,
                                      const DerivedChannels& derived, const SamplingSettings& sampling,
                                      const DiagnosticSink& sink) {
  static const BackendRegistry kBackends({cpu::backend_entry(), opencl::backend_entry()});
  BackendRequest request;
  request.backend = backend_name(options.resolve(), options.method);
  if (options.device_memory) request.device_memory = parse_bytes("--device-memory", *options.device_memory);
  request.isa = options.isa.value_or("auto");
  request.threads = options.threads.value_or(0);
  request.device = options.device;
  request.sink = sink;
  return kBackends.make(request, {std::move(scene), derived, sampling});
}

}  // namespace kiloband
