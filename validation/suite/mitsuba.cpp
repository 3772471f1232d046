#include "validation/suite/mitsuba.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include "base/error.hpp"
#include "validation/suite/error_rates.hpp"

namespace kiloband::validation {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

constexpr std::string_view kSection = "mitsuba/";
/// Factor of the sample counts of validation/mitsuba; a quick run has no such case.
constexpr ByEffort<double> kEffort{0, 0.25, 1};

/// "mitsuba", "mitsuba/", "mitsuba/glass": nothing else can be meant.
bool means_mitsuba(const std::string& name) {
  return name.starts_with(kSection) || name == kSection.substr(0, kSection.size() - 1);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

std::optional<MitsubaDriver> probe(const std::string& interpreter, const fs::path& script) {
  const ChildEnd version = run_child({interpreter, script.string(), "--probe"}, {}, {});
  if (version.code != 0 || lines_of(version.out).empty()) return std::nullopt;
  const ChildEnd list = run_child({interpreter, script.string(), "--list"}, {}, {});
  if (list.code != 0 || lines_of(list.out).empty()) return std::nullopt;
  return MitsubaDriver{interpreter, lines_of(version.out).back(), script, lines_of(list.out)};
}

std::string failure_of(const MitsubaScene& scene) {
  std::string text =
      fmt::format("channel means: p {:.3g}, level {:.3g}, largest difference {:+.3g} %", scene.figure("/p"),
                  scene.figure("/level"), 100 * scene.figure("/largest_difference"));
  if (const auto pixels = scene.entry.find("pixels"); pixels != scene.entry.end() && pixels->is_object())
    text += fmt::format("; {}: p {:.3g}", pixels->at("name").get<std::string>(), scene.figure("/pixels/p"));
  return text;
}

/// throws json::exception  it is no such entry
MitsubaScene scene_of(const json& entry) {
  MitsubaScene scene{entry.at("name"), entry.at("backend"), entry.at("passed").get<bool>(), {}, entry};
  if (!scene.passed) scene.failure = failure_of(scene);
  return scene;
}

/// What the file says; `problem`: why it cannot be read to its end.
MitsubaResult parsed(const std::string& text, std::string& problem) {
  MitsubaResult result;
  if (text.empty()) return result;
  try {
    result.record = json::parse(text);
    const json scenes = result.record.at("scenes");
    result.record.erase("scenes");
    for (const json& entry : scenes) result.scenes.push_back(scene_of(entry));
  } catch (const json::exception& error) {
    problem = std::string("mitsuba.json cannot be read: ") + error.what();
  }
  return result;
}

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::string joined(const std::vector<std::string>& parts) {
  return fmt::format("{}", fmt::join(parts, ","));
}

std::vector<std::string> command_of(const MitsubaDriver& driver, const MitsubaRun& run) {
  std::vector<std::string> command{driver.interpreter,
                                   driver.script.string(),
                                   fs::absolute(run.program).string(),
                                   "-o",
                                   fs::absolute(run.output).string(),
                                   "--backends",
                                   joined(run.backends),
                                   "--seed",
                                   fmt::format("{}", run.seed),
                                   "--rate",
                                   fmt::format("{}", kMitsubaRate),
                                   "--effort",
                                   fmt::format("{}", kEffort.at(run.effort)),
                                   "--scenes"};
  command.insert(command.end(), run.scenes.begin(), run.scenes.end());
  return command;
}

}  // namespace

double MitsubaScene::figure(const char* pointer) const {
  const json::json_pointer at(pointer);
  return entry.contains(at) && entry[at].is_number() ? entry[at].get<double>()
                                                     : std::numeric_limits<double>::quiet_NaN();
}

bool MitsubaResult::passed() const {
  return std::ranges::all_of(scenes, &MitsubaScene::passed);
}

bool wants_mitsuba(const std::vector<std::string>& names, Effort effort) {
  if (effort == Effort::kQuick) return false;
  return names.empty() || std::ranges::any_of(names, [](const std::string& name) {
           return means_mitsuba(name) || kSection.starts_with(name);
         });
}

std::optional<MitsubaDriver> find_mitsuba(const MitsubaSearch& search, const std::vector<std::string>& names,
                                          Effort effort) {
  const auto named = std::ranges::find_if(names, means_mitsuba);
  if (named != names.end() && effort == Effort::kQuick)
    throw InputError(*named + ": a quick run has no case against Mitsuba (leave out --quick)");
  if (!wants_mitsuba(names, effort)) return std::nullopt;
  for (const std::string& interpreter : search.interpreters) {
    if (auto driver = probe(interpreter, search.script)) return driver;
  }
  if (named != names.end())
    throw InputError(*named + ": Mitsuba 3 is not there (pip install mitsuba scipy), looked for by " +
                     fmt::format("{}", fmt::join(search.interpreters, " and ")));
  return std::nullopt;
}

std::vector<std::string> mitsuba_backends(const std::vector<std::string>& backends, Effort effort) {
  if (effort == Effort::kThorough) return backends;
  std::vector<std::string> chosen;
  const auto kind = [](const std::string& backend) { return backend.substr(0, backend.find(':')); };
  for (const std::string& backend : backends) {
    if (std::ranges::find(chosen, kind(backend), kind) == chosen.end()) chosen.push_back(backend);
  }
  return chosen;
}

MitsubaResult read_mitsuba(const std::string& text, const MitsubaRun& run, const ChildEnd& end) {
  std::string problem;
  MitsubaResult found = parsed(text, problem);
  const bool ended_well = end.code == 0 || end.code == 1;
  if (!ended_well || problem.empty()) problem = "compare_with_mitsuba.py: " + end.description();
  MitsubaResult result = found;
  result.scenes.clear();
  bool missing = false;
  for (const std::string& name : run.scenes) {
    for (const std::string& backend : run.backends) {
      const auto at = std::ranges::find_if(
          found.scenes, [&](const MitsubaScene& s) { return s.name == name && s.backend == backend; });
      if (at != found.scenes.end()) {
        result.scenes.push_back(*at);
      } else if (!end.stopped) {
        missing = true;
        result.scenes.push_back({name, backend, false, problem, {}});
      }
    }
  }
  if (!ended_well && !missing && !end.stopped && !result.scenes.empty()) {  // it failed behind the last scene
    result.scenes.back().passed = false;
    result.scenes.back().failure = problem;
  }
  return result;
}

MitsubaResult run_mitsuba(const MitsubaDriver& driver, const MitsubaRun& run, const Watch& watch) try {
  const fs::path file = run.output / "mitsuba.json";
  fs::remove(file);  // of an earlier run
  const double rows = static_cast<double>(run.scenes.size() * run.backends.size());
  double done = 0;
  const ChildEnd end = run_child(command_of(driver, run), watch, [&](const std::string&) {
    if (watch.progress) watch.progress(++done / rows);
  });
  return read_mitsuba(contents(file), run, end);
} catch (const std::exception& error) {  // the rest of the run is worth having
  ChildEnd end;
  end.err = error.what();
  return read_mitsuba({}, run, end);
}

}  // namespace kiloband::validation
