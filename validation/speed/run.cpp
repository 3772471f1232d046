#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/error.hpp"
#include "base/json_dump.hpp"
#include "files/atomic_file.hpp"
#include "files/output_target.hpp"
#include "validation/speed/bench.hpp"
#include "validation/speed/subject.hpp"

namespace kiloband::speed {
namespace fs = std::filesystem;
namespace {

using nlohmann::ordered_json;

CaseOutcome outcome_of(const Case& c, const Settings& settings, const Watch& watch) {
  CaseOutcome outcome{c.name, {}, 0, load_average(), false, {}};
  const auto start = std::chrono::steady_clock::now();
  Bench bench(settings, watch);
  try {
    c.run(bench);
    outcome.complete = !watch.stopped();
  } catch (const std::logic_error&) {  // our bug: not to be hidden in a file
    throw;
  } catch (const std::exception& error) {
    outcome.failure = error.what();
  }
  outcome.records = bench.records();
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

ordered_json json_of(const CaseOutcome& c, const Settings& settings) {
  ordered_json j;
  j["name"] = c.name;
  j["command"] = bench_command(settings, c.name);
  j["complete"] = c.complete;
  j["failure"] = c.failure.empty() ? ordered_json() : ordered_json(c.failure);
  j["seconds"] = c.seconds;
  j["load_before"] = c.load_before;
  j["records"] = c.records.size();
  return j;
}

}  // namespace

bool Settings::opencl() const {
  return std::ranges::any_of(backends, [](const std::string& name) { return name.starts_with("opencl"); });
}

bool RunOutcome::failed() const {
  return std::ranges::any_of(cases, [](const CaseOutcome& c) { return !c.failure.empty(); });
}

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{
      {"channels", "paths and frames per second against the number of channels", 7, 600, run_channels},
      {"pool", "sizes of the OpenCL pool: speed, and what fits into memory", 6, 150, run_pool},
      {"memory", "memory against channels and depth, measured", 4, 60, run_memory},
      {"refraction", "degradation against spectral MIS at 64 wavelengths", 4, 150, run_refraction},
      {"error", "error against time: backends, methods, wavelength modes, samplers", 5, 600, run_error},
      {"stages", "time by stage, and the attained part of its limit", 7, 180, run_stages},
      {"peers", "other renderers: paths per second, time to equal error", 5, 320, run_peers},
      {"split", "paths that carry a part of the channels", 4, 240, run_split},
  };
  return kCases;
}

std::vector<Case> chosen_cases(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const Case& c : cases()) known.push_back(c.name);
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) == known.end())
      throw InputError(fmt::format("no case '{}': there are {}", name, fmt::join(known, ", ")));
  }
  std::vector<Case> chosen;
  for (const Case& c : cases())
    if (names.empty() || std::ranges::find(names, c.name) != names.end()) chosen.push_back(c);
  return chosen;
}

RunOutcome run_cases(const std::vector<Case>& cases, const Settings& settings, const Watch& watch,
                     const std::function<void(const std::string& name)>& begun,
                     const std::function<void(const RunOutcome& run)>& kept) {
  RunOutcome run;
  run.interrupted = true;  // until all is done
  double all = 0, done = 0;
  const auto share = [&](const Case& c) { return settings.quick ? c.quick : c.full; };
  for (const Case& c : cases) all += share(c);
  for (const Case& c : cases) {
    if (watch.stopped()) break;
    begun(c.name);
    const auto progress = [&](double fraction) {
      if (watch.progress) watch.progress((done + share(c) * fraction) / all);
    };
    progress(0);
    run.cases.push_back(outcome_of(c, settings, {watch.stop, progress}));
    run.seconds += run.cases.back().seconds;
    done += share(c);
    if (kept) kept(run);
  }
  if (watch.progress) watch.progress(done / all);
  run.interrupted = watch.stopped();
  return run;
}

void prepare_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw DeviceError(folder.string() + ": " + error.message());
  check_writable(folder / "bench.json");
  for (const char* name : {"bench.json", "bench.csv", "report.html"}) {
    error = remove_output(folder / name);
    if (error) throw DeviceError((folder / name).string() + ": " + error.message());
  }
}

void write_results(const fs::path& folder, const RunOutcome& run, const Settings& settings,
                   const ordered_json& machine) {
  ordered_json json;
  json["format"] = "kiloband bench 1";
  json["machine"] = machine;
  json["quick"] = settings.quick;
  json["seed"] = settings.seed;
  json["seconds"] = run.seconds;
  json["interrupted"] = run.interrupted;
  json["cases"] = ordered_json::array();
  json["records"] = ordered_json::array();
  std::vector<Record> all;
  for (const CaseOutcome& c : run.cases) {
    json["cases"].push_back(json_of(c, settings));
    for (const Record& record : c.records) {
      json["records"].push_back(to_json(record));
      all.push_back(record);
    }
  }
  write_file_atomically(folder / "bench.csv", to_csv(all));
  write_file_atomically(folder / "bench.json", dump_json(json, 1) + "\n");
}

}  // namespace kiloband::speed
