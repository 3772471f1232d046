#include "validation/suite/mitsuba.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

#include "base/error.hpp"
#include "validation/suite/error_rates.hpp"

namespace kiloband::validation {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

constexpr std::string_view kSection = "mitsuba/";
/// Factor of the sample counts of mitsuba_cases(); a quick run has no such case.
constexpr ByEffort<double> kEffort{0, 0.25, 1};

/// "mitsuba", "mitsuba/", "mitsuba/glass": nothing else can be meant.
bool means_mitsuba(const std::string& name) {
  return name.starts_with(kSection) || name == kSection.substr(0, kSection.size() - 1);
}

std::optional<MitsubaDriver> probe(const std::string& interpreter, const MitsubaSearch& search) {
  const fs::path script = fs::absolute(search.root) / "validation/mitsuba/render_mitsuba.py";
  const ChildEnd end = run_child({interpreter, script.string(), "--probe"}, {}, {});
  const json versions = json::parse(end.out, nullptr, false);
  if (end.code != 0 || !versions.is_object()) return std::nullopt;
  return MitsubaDriver{interpreter, versions, script, mitsuba_cases(search.root)};
}

uint32_t scaled(uint32_t samples, Effort effort) {
  return std::max(1u, static_cast<uint32_t>(std::lround(kEffort.at(effort) * samples)));
}

/// One run: Mitsuba's images of a scene, then ours on every backend.
class Run {
 public:
  Run(const MitsubaDriver& driver, const MitsubaRun& run, const Watch& watch)
      : driver_(driver), run_(run), watch_(watch) {
    result_.record = driver.versions;
    result_.record["rate"] = kMitsubaRate;
  }

  MitsubaResult finish() {
    for (const MitsubaCase& c : driver_.scenes) {
      if (watch_.stopped()) break;
      if (std::ranges::find(run_.scenes, c.name) == run_.scenes.end()) continue;
      try {
        compare(c);
      } catch (const std::exception& error) {  // the rest of the run is worth having
        fail_rest(c, error.what());
      }
    }
    return std::move(result_);
  }

 private:
  /// A share for Mitsuba, which takes longest, and one for each backend.
  void report(double scene_done) const {
    if (!watch_.progress) return;
    const double scenes = static_cast<double>(run_.scenes.size() * run_.backends.size());
    watch_.progress((static_cast<double>(result_.scenes.size()) + scene_done) / scenes);
  }

  void compare(const MitsubaCase& c) {
    const fs::path stem = fs::absolute(run_.output) / "mitsuba" / c.name;
    const uint32_t samples = scaled(c.theirs, run_.effort);
    const auto start = std::chrono::steady_clock::now();
    const ChildEnd end = run_child(command(c, stem, samples), watch_, {});
    if (end.stopped) return;
    if (end.code != 0) return fail_rest(c, "render_mitsuba.py: " + end.description());
    const stats::ReplicateImage theirs = read_mitsuba_cubes(stem, samples);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const auto scene = load({c.file, {}, kMitsubaBands, kMitsubaSize, kMitsubaSize});
    for (std::size_t i = 0; i < run_.backends.size(); ++i) {
      // Backends get seeds of their own: what one sees is no repetition of another.
      const Sampling sampling{run_.seed + i, kMitsubaReplicates, scaled(c.ours, run_.effort)};
      const Rendering ours = render(scene, {.backend = run_.backends[i]}, sampling, {watch_.stop, {}});
      if (ours.stopped) return;
      result_.scenes.push_back(compare_with_mitsuba(c, run_.backends[i], ours, theirs, level()));
      result_.scenes.back().entry["seconds_theirs"] = seconds.count();
      report(0);
    }
  }

  std::vector<std::string> command(const MitsubaCase& c, const fs::path& stem, uint32_t samples) const {
    fs::create_directories(stem.parent_path());
    return {driver_.interpreter,
            driver_.script.string(),
            c.file.string(),
            "--bands",
            kMitsubaBands,
            "-o",
            stem.string() + ".hdr",
            "--size",
            fmt::format("{0}x{0}", kMitsubaSize),
            "--spp",
            fmt::format("{}", samples),
            "--replicates",
            fmt::format("{}", kMitsubaReplicates),
            "--seed",
            fmt::format("{}", run_.seed + 1)};
  }

  /// Of one comparison; their sum is the rate of the run.
  double level() const {
    return kMitsubaRate / static_cast<double>(run_.scenes.size() * run_.backends.size());
  }

  /// The backends that the scene has not been compared on.
  void fail_rest(const MitsubaCase& c, const std::string& why) {
    const auto done =
        static_cast<std::size_t>(std::ranges::count(result_.scenes, c.name, &MitsubaScene::name));
    for (std::size_t i = done; i < run_.backends.size(); ++i)
      result_.scenes.push_back({c.name, run_.backends[i], false, why, {}});
    report(0);
  }

  const MitsubaDriver& driver_;
  const MitsubaRun& run_;
  const Watch& watch_;
  MitsubaResult result_;
};

}  // namespace

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
    if (auto driver = probe(interpreter, search)) return driver;
  }
  if (named != names.end())
    throw InputError(*named + ": Mitsuba 3 is not there (pip install mitsuba), looked for by " +
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

MitsubaResult run_mitsuba(const MitsubaDriver& driver, const MitsubaRun& run, const Watch& watch) {
  return Run(driver, run, watch).finish();
}

}  // namespace kiloband::validation
