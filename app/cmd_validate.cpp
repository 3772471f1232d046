// kiloband validate [CASE]...: the statistical validation suite (validation/README.md), with a report.
#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <optional>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/run_progress.hpp"
#include "app/console/standard_output.hpp"
#include "app/console/stop_signals.hpp"
#include "app/options/whole_numbers.hpp"
#include "app/report_page.hpp"
#include "app/source_folder.hpp"
#include "base/error.hpp"
#include "scenes/generator/scenes.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/device/device.hpp"
#include "validation/suite/results.hpp"

namespace kiloband {
namespace {

namespace fs = std::filesystem;
using namespace validation;

struct ValidateOptions {
  std::vector<std::string> names, backends;
  bool quick = false, thorough = false, list = false, quiet = false, no_report = false;
  uint64_t seed = 1;
  std::string output = "validation_results", scenes = source_folder(), data;
};

Effort effort_of(const ValidateOptions& options) {
  if (options.quick) return Effort::kQuick;
  return options.thorough ? Effort::kThorough : Effort::kStandard;
}

/// Every backend that there is, unless --backends names some.
std::vector<std::string> backends_of(const ValidateOptions& options) {
  if (!options.backends.empty()) return options.backends;
  std::vector<std::string> backends{"cpu"};
  if (opencl::list_devices().empty()) {
    tell("no OpenCL device: the CPU backend alone, against closed forms and between its modes\n");
  } else {
    backends.insert(backends.end(), {"opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"});
  }
  return backends;
}

RunRecord record_of(const std::vector<std::string>& backends) {
  RunRecord record{"kiloband " KILOBAND_VERSION,
                   cpu::processor_name(),
                   fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))),
                   {}};
  for (const std::string& backend : backends)
    record.backends.push_back(backend == "cpu" ? backend
                                               : backend + " on " + opencl::select_device(std::nullopt).name);
  return record;
}

/// The large scenes' geometry is computed where a case needs it.
void generate_scenes(const SuiteSettings& settings) {
  const fs::path committed = settings.folders.scenes;
  for (const generator::KnownScene& known : generator::known_scenes()) {
    const auto names_it = [&](const std::string& name) { return known.name.starts_with(name); };
    if (!settings.names.empty() && std::ranges::none_of(settings.names, names_it)) continue;
    tell("computing the scene {}\n", known.name);
    generator::write_scene(known.make(), committed, settings.folders.generated);
  }
}

const char* word_of(bool passed, bool interrupted) {
  return !passed ? "FAILED" : interrupted ? "stopped" : "passed";
}

void print_case(const CaseResult& c) {
  if (!c.error.empty()) return answer("FAILED  {}: {}\n", c.what.name, c.error);
  double bias = -1;
  for (const PairingResult& r : c.pairings) {
    for (const stats::TestVerdict& v : r.comparison.tests)
      if (v.name == "mean/image" && v.detectable.typical > bias) bias = v.detectable.typical;
  }
  answer("{}  {}: {} comparisons, image means would show {}\n", word_of(c.passed, c.interrupted), c.what.name,
         c.pairings.size(), bias < 0 ? "nothing" : fmt::format("{:.2g} %", 100 * bias));
  for (const PairingResult& r : c.pairings) {
    if (r.passed) continue;
    const stats::TestVerdict& v = r.comparison.decisive();
    answer("        {} / {}: {} p {:.2g} (level {:.2g}), invalid samples {}\n", r.pairing.a.label(),
           r.pairing.kind == Pairing::Kind::kClosedForm ? "closed form" : r.pairing.b.label(), v.name, v.p,
           v.level, r.invalid_samples);
  }
}

void print_mitsuba(const MitsubaScene& s) {
  if (!s.passed) return answer("FAILED  mitsuba/{} on {}: {}\n", s.name, s.backend, s.failure);
  answer("passed  mitsuba/{} on {}: largest difference {:+.2g} %, would show {:.2g} %\n", s.name, s.backend,
         100 * s.figure("/largest_difference"), 100 * s.figure("/detectable/typical"));
}

void print_verdict(const SuiteResult& result) {
  for (const CaseResult& c : result.cases) print_case(c);
  for (const HardCaseResult& h : result.hard_cases) {
    answer("{}  hard/{} on {}: {} figures\n", h.passed ? "passed" : "FAILED", h.name, h.backend,
           h.figures.size());
    for (const HardFigure& f : h.figures)
      if (!f.pass)
        answer("        {}: {:.6g} {} instead of {:.6g}, limit {:.2g}\n", f.name, f.value, f.unit,
               f.reference, f.limit);
    if (!h.error.empty()) answer("        {}\n", h.error);
  }
  for (const ConvergenceResult& c : result.convergence)
    answer("{}  {}: {} curves {}\n", word_of(c.passed, c.interrupted), c.name, c.curves.size(), c.note);
  for (const MitsubaScene& s : result.mitsuba.scenes) print_mitsuba(s);
  std::size_t made = 0;
  for (const CaseResult& c : result.cases) made += c.pairings.size();
  answer("{}: {} of {} comparisons in {:.0f} s, family-wise error rate {:.0e}\n",
         result.interrupted ? "interrupted"
         : result.passed()  ? "all passed"
                            : "FAILED",
         made, result.comparisons, result.seconds, kRunRate);
}

/// The independent renderer is optional, unless a name asks for it.
std::optional<MitsubaDriver> mitsuba_of(const ValidateOptions& options) {
  auto driver = find_mitsuba({.root = options.scenes}, options.names, effort_of(options));
  if (!driver && wants_mitsuba(options.names, effort_of(options)))
    tell("note: Mitsuba 3 is not there (pip install mitsuba): no case mitsuba/...\n");
  return driver;
}

SuiteSettings settings_of(const ValidateOptions& options) {
  if (options.quick && options.thorough) throw InputError("--quick together with --thorough");
  const fs::path root = fs::absolute(options.scenes);
  std::error_code unknown;
  if (!fs::is_directory(root / "scenes/analytic", unknown))
    throw InputError(options.scenes +
                     ": no folder scenes/analytic there (--root must name kiloband's source folder)");
  SuiteSettings settings;
  settings.names = options.names;
  settings.backends = backends_of(options);
  settings.effort = effort_of(options);
  settings.seed = options.seed;
  settings.folders = {root / "scenes", root / "validation/scenes", fs::path(options.output) / "scenes",
                      options.data};
  settings.mitsuba = mitsuba_of(options);
  settings.program = fs::read_symlink("/proc/self/exe");
  settings.output = options.output;
  return settings;
}

int validate(const ValidateOptions& options) {
  const SuiteSettings settings = settings_of(options);
  const std::vector<std::string> names = planned_names(settings);
  if (options.list) {
    for (const std::string& name : names) answer("{}\n", name);
    return kDone;
  }
  const RunRecord record = record_of(settings.backends);
  prepare_results(options.output);
  if (settings.effort != Effort::kQuick) generate_scenes(settings);
  catch_stop_signals();
  RunProgress progress(!options.quiet);
  const Watch watch{&stop_requested, [&](double fraction) { progress.update(fraction); }};
  const SuiteResult result = run_suite(
      settings, watch, [&](const std::string& name) { progress.begin(name); },
      [&](const SuiteResult& so_far) { write_verdicts(options.output, so_far, record); });
  progress.end();
  write_results(options.output, result, record);
  print_verdict(result);
  if (!options.no_report) make_report_page(options.scenes, "report.py", options.output, "results.json");
  if (result.interrupted) return kInterrupted;
  return result.passed() ? kDone : kFailed;
}

}  // namespace

Command add_validate(CLI::App& program) {
  auto options = std::make_shared<ValidateOptions>();
  CLI::App& command = *program.add_subcommand(
      "validate", "Compare backends with each other and with theory; writes a report");
  command.add_option("CASE", options->names, "cases whose names begin so; default: all (--list)");
  command
      .add_option(
          "--backends", options->backends,
          "cpu,opencl:dpept-batch,opencl:dpept-path,opencl:pt; the first is what others are held against")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"cpu", "opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"}));
  command.add_flag("--quick", options->quick, "a minute or two");
  command.add_flag("--thorough", options->thorough, "hours");
  command.add_option("--seed", options->seed, "of all random numbers")
      ->transform(any_whole_number())
      ->capture_default_str();
  command.add_option("-o,--output", options->output, "folder of the results")->capture_default_str();
  command.add_option("--root", options->scenes, "kiloband's source folder, with scenes/ and validation/");
  command
      .add_option("--data", options->data,
                  "folder of public inputs (validation/scenes/real): also the cases real/...")
      ->check(CLI::ExistingDirectory);
  command.add_flag("--no-report", options->no_report, "results.json and junit.xml alone");
  command.add_flag("--list", options->list, "name the cases");
  command.add_flag("--quiet", options->quiet, "no progress");
  return [options] { return validate(*options); };
}

}  // namespace kiloband
