// kiloband bench [CASE]...: speed, and speed against error (docs/bench.md).
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/run_progress.hpp"
#include "app/console/standard_output.hpp"
#include "app/console/stop_signals.hpp"
#include "app/options/backend_options.hpp"
#include "app/options/whole_numbers.hpp"
#include "app/report_page.hpp"
#include "app/source_folder.hpp"
#include "base/error.hpp"
#include "src_gpu/device/device.hpp"
#include "validation/speed/bench.hpp"

namespace kiloband {
namespace {

namespace fs = std::filesystem;

struct BenchOptions {
  std::vector<std::string> names, backends;
  bool quick = false, list = false, quiet = false, no_report = false;
  uint64_t seed = 1;
  std::string output = "bench_results", root = source_folder(), data;
  std::optional<std::string> device, device_memory;
};

/// Those that are named, or all that there are.
/// throws DeviceError, InputError  OpenCL is asked for, and there is no such device
std::vector<std::string> backends_of(const BenchOptions& options) {
  const std::vector<std::string> all{"cpu", "opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"};
  const std::vector<std::string>& wanted = options.backends.empty() ? all : options.backends;
  const bool asked =
      options.device || (!options.backends.empty() && wanted != std::vector<std::string>{"cpu"});
  if (asked) opencl::select_device(options.device);
  if (asked || wanted.size() == 1 || !opencl::list_devices().empty()) return wanted;
  if (!options.quiet) tell("no OpenCL device: the CPU backend alone\n");
  return {"cpu"};
}

speed::Settings settings_of(const BenchOptions& options) {
  std::error_code unknown;
  if (!fs::is_directory(fs::path(options.root) / "validation/report", unknown))
    throw InputError(options.root +
                     ": no folder validation/report there (--root must name kiloband's source folder)");
  speed::Settings settings;
  settings.quick = options.quick;
  settings.seed = options.seed;
  settings.root = fs::absolute(options.root);
  if (!options.data.empty()) settings.data = fs::canonical(options.data);
  settings.output = fs::absolute(options.output);
  settings.program = fs::read_symlink("/proc/self/exe");
  settings.backends = backends_of(options);
  settings.device = options.device;
  if (options.device_memory) settings.device_memory = parse_bytes("--device-memory", *options.device_memory);
  return settings;
}

/// Options that nothing would read.
void check_applies(const BenchOptions& options, const speed::Settings& settings,
                   const std::vector<speed::Case>& cases) {
  if (options.device && !settings.opencl())
    throw InputError("--device: no OpenCL backend takes part (--backends)");
  const bool pool = std::ranges::any_of(cases, [](const speed::Case& c) { return c.name == "pool"; });
  if (options.device_memory && !(pool && settings.opencl()))
    throw InputError(
        "--device-memory: is read by the case pool on an OpenCL device, which does not take part");
}

int list_cases(const std::vector<speed::Case>& cases) {
  for (const speed::Case& c : cases) answer("{:<11} {}\n", c.name, c.what);
  return kDone;
}

void print_outcome(const speed::RunOutcome& run) {
  for (const speed::CaseOutcome& c : run.cases) {
    if (!c.failure.empty()) {
      answer("FAILED  {}: {}\n", c.name, c.failure);
    } else {
      answer("{}  {}: {} numbers in {:.0f} s\n", c.complete ? "done   " : "stopped", c.name, c.records.size(),
             c.seconds);
    }
  }
}

int bench(const BenchOptions& options) {
  const std::vector<speed::Case> cases = speed::chosen_cases(options.names);
  if (options.list) return list_cases(cases);
  const speed::Settings settings = settings_of(options);
  check_applies(options, settings, cases);
  speed::prepare_folder(options.output);
  const auto machine = speed::machine_json(settings, "kiloband " KILOBAND_VERSION);
  catch_stop_signals();
  RunProgress progress(!options.quiet);
  const speed::Watch watch{&stop_requested, [&](double fraction) { progress.update(fraction); }};
  const speed::RunOutcome run = speed::run_cases(
      cases, settings, watch, [&](const std::string& name) { progress.begin(name); },
      [&](const speed::RunOutcome& so_far) {
        speed::write_results(options.output, so_far, settings, machine);
      });
  progress.end();
  speed::write_results(options.output, run, settings, machine);
  print_outcome(run);
  if (!options.no_report) make_report_page(settings.root, "speed_report.py", options.output, "bench.json");
  if (run.interrupted) return kInterrupted;
  return run.failed() ? kMachineFailed : kDone;
}

}  // namespace

Command add_bench(CLI::App& program) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App& command =
      *program.add_subcommand("bench", "Measure speed, and speed against error; writes a page of figures");
  command.add_option("CASE", options->names, "what is measured; default: all (--list)");
  command
      .add_option("--backends", options->backends,
                  "cpu,opencl:dpept-batch,opencl:dpept-path,opencl:pt (the default)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"cpu", "opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"}));
  command.add_flag("--quick", options->quick, "small images and few channels: about a minute");
  command.add_option("--seed", options->seed, "of all random numbers")
      ->transform(any_whole_number())
      ->capture_default_str();
  command.add_option("-o,--output", options->output, "folder of the results")->capture_default_str();
  command.add_option("--device", options->device,
                     "opencl: index or part of the name, as `kiloband devices` lists them");
  command.add_option("--device-memory", options->device_memory,
                     "opencl: memory that the case pool may use, such as 4GiB");
  command.add_option("--root", options->root, "kiloband's source folder, with scenes/ and validation/");
  command
      .add_option("--data", options->data, "folder of public inputs (validation/scenes/real): more scenes")
      ->envname("KILOBAND_DATA")
      ->check(CLI::ExistingDirectory);
  command.add_flag("--no-report", options->no_report, "bench.json and bench.csv alone");
  command.add_flag("--list", options->list, "name the cases");
  command.add_flag("--quiet", options->quiet, "no progress");
  return [options] { return bench(*options); };
}

}  // namespace kiloband
