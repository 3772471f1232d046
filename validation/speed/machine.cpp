#include <fmt/chrono.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>

#include "src_cpu/cpu_backend.hpp"
#include "src_cpu/lanes/isa.hpp"
#include "src_gpu/device/device.hpp"
#include "src_gpu/tuning/tuning_store.hpp"
#include "validation/speed/bench.hpp"
#include "validation/suite/child_process.hpp"

namespace kiloband::speed {
namespace {

using nlohmann::ordered_json;

/// Of the source folder, with a "+" where it has changes; null where it is no git checkout or there is no git.
ordered_json commit_of(const std::filesystem::path& root) {
  const auto git = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"git", "-C", root.string()});
    return validation::run_child(arguments, {}, {});
  };
  const auto head = git({"rev-parse", "--short=12", "HEAD"});
  if (head.code != 0) return nullptr;
  const auto changes = git({"status", "--porcelain", "--untracked-files=no"});
  return head.out.substr(0, head.out.find('\n')) + (changes.out.empty() ? "" : "+");
}

/// Sizes that `kiloband tune` has kept for the device: renders use them, so its speeds are of them.
ordered_json tuned_sizes(const opencl::DeviceInfo& device) {
  ordered_json list = ordered_json::array();
  for (const opencl::TunedMethod& one : opencl::TuningStore::of_user().load(device))
    list.push_back(
        {{"method", one.method}, {"channels", one.channels}, {"sizes", opencl::describe(one.tuning)}});
  return list;
}

ordered_json device_of(const Settings& settings) {
  if (!settings.opencl()) return nullptr;
  const opencl::DeviceInfo device = opencl::select_device(settings.device);
  return {{"name", device.name},
          {"type", opencl::to_string(device.type)},
          {"platform", device.platform},
          {"driver", device.driver_version},
          {"compute_units", device.compute_units},
          {"memory_bytes", device.global_memory},
          {"tuned", tuned_sizes(device)}};
}

}  // namespace

double load_average() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : kNone;
}

ordered_json machine_json(const Settings& settings, const std::string& version) {
  ordered_json j;
  j["processor"] = cpu::processor_name();
  j["isa"] = cpu::to_string(cpu::resolve_isa(cpu::Isa::kAuto));
  j["threads"] = sysconf(_SC_NPROCESSORS_ONLN);
  j["memory_bytes"] =
      static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  j["opencl"] = device_of(settings);
  j["version"] = version;
  j["commit"] = commit_of(settings.root);
  j["date"] = fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)));
  j["load_average"] = load_average();
  return j;
}

}  // namespace kiloband::speed
