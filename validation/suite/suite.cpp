#include "validation/suite/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "base/error.hpp"

namespace kiloband::validation {
namespace {

bool wanted(const std::string& name, const std::vector<std::string>& names) {
  return names.empty() ||
         std::ranges::any_of(names, [&](const std::string& n) { return name.starts_with(n); });
}

struct Plan {
  std::vector<Case> cases;
  std::vector<std::pair<const HardCase*, std::string>> hard_cases;  // and backend
  std::vector<ConvergenceCase> convergence;
  std::vector<std::string> mitsuba;  // scenes

  std::size_t parts() const {
    return cases.size() + hard_cases.size() + convergence.size() + (mitsuba.empty() ? 0 : 1);
  }
};

std::vector<std::string> names_of(const Plan& plan) {
  std::vector<std::string> names;
  for (const Case& c : plan.cases) names.push_back(c.name);
  for (const auto& [hard, backend] : plan.hard_cases) {
    if (backend == plan.hard_cases.front().second) names.push_back("hard/" + hard->name);
  }
  for (const ConvergenceCase& c : plan.convergence) names.push_back(c.name);
  for (const std::string& scene : plan.mitsuba) names.push_back("mitsuba/" + scene);
  return names;
}

/// What is misspelt, or needs another effort or --data, must not count as passed.
void check_names(const std::vector<std::string>& asked, const Plan& plan) {
  const std::vector<std::string> names = names_of(plan);
  for (const std::string& name : asked) {
    if (std::ranges::none_of(names, [&](const std::string& n) { return n.starts_with(name); }))
      throw InputError(name +
                       ": no case of this run has such a name (kiloband validate --list names them; some "
                       "need --data, some are not in quick runs)");
  }
}

Plan plan_of(const SuiteSettings& settings) {
  Plan plan;
  for (Case& c : all_cases(settings.folders)) {
    if (settings.effort >= c.least && wanted(c.name, settings.names)) plan.cases.push_back(std::move(c));
  }
  for (const HardCase& hard : hard_cases()) {
    if (!wanted("hard/" + hard.name, settings.names)) continue;
    for (const std::string& backend : settings.backends) plan.hard_cases.emplace_back(&hard, backend);
  }
  for (ConvergenceCase& c : convergence_cases(settings.folders)) {
    if (wanted(c.name, settings.names)) plan.convergence.push_back(std::move(c));
  }
  if (settings.mitsuba) {
    for (const MitsubaCase& scene : settings.mitsuba->scenes)
      if (wanted("mitsuba/" + scene.name, settings.names)) plan.mitsuba.push_back(scene.name);
  }
  check_names(settings.names, plan);
  return plan;
}

HardCaseResult run_hard_case(const HardCase& hard, const std::string& backend, const SuiteSettings& settings,
                             const Watch& watch) {
  HardCaseResult result{hard.name, hard.what, backend, {}, false, {}};
  try {
    result.figures = hard.run({backend, settings.effort, settings.seed, {watch.stop, {}}});
    result.passed = std::ranges::all_of(result.figures, &HardFigure::pass);
  } catch (const std::exception& error) {
    result.error = error.what();
  }
  return result;
}

MitsubaRun mitsuba_run(const Plan& plan, const SuiteSettings& settings) {
  return {settings.output, plan.mitsuba, mitsuba_backends(settings.backends, settings.effort),
          settings.effort, settings.seed};
}

/// Progress of the run from that of its parts.
class Counter {
 public:
  Counter(std::size_t parts, const Watch& watch) : parts_(static_cast<double>(parts)), watch_(watch) {}

  Watch part() {
    return {watch_.stop, [this](double fraction) {
              if (watch_.progress) watch_.progress((done_ + std::min(fraction, 1.0)) / parts_);
            }};
  }
  void finish_part() {
    ++done_;
    if (watch_.progress) watch_.progress(done_ / parts_);
  }

 private:
  double parts_, done_ = 0;
  const Watch& watch_;
};

std::size_t family_of(const Plan& plan, const SuiteSettings& settings) {
  std::size_t comparisons = 0;
  for (const Case& c : plan.cases) comparisons += pairings_of(c, settings.backends, settings.effort).size();
  return comparisons;
}

}  // namespace

bool SuiteResult::passed() const {
  return !interrupted && std::ranges::all_of(cases, &CaseResult::passed) &&
         std::ranges::all_of(hard_cases, &HardCaseResult::passed) &&
         std::ranges::all_of(convergence, &ConvergenceResult::passed) && mitsuba.passed();
}

void bound_statistical_figures(std::vector<HardCaseResult>& hard_cases) {
  std::map<std::string, std::size_t> counts;
  for (HardCaseResult& hard : hard_cases) {
    std::size_t& count = counts[hard.backend];
    count += static_cast<std::size_t>(std::ranges::count_if(hard.figures, &HardFigure::statistical));
    if (count <= kHardStatisticalFigures) continue;
    hard.passed = false;
    hard.error = fmt::format("{} statistical figures so far, the rate is divided over {}", count,
                             kHardStatisticalFigures);
  }
}

std::vector<std::string> planned_names(const SuiteSettings& settings) {
  return names_of(plan_of(settings));
}

SuiteResult run_suite(const SuiteSettings& settings, const Watch& watch,
                      const std::function<void(const std::string&)>& say,
                      const std::function<void(const SuiteResult&)>& keep) {
  const auto start = std::chrono::steady_clock::now();
  const Plan plan = plan_of(settings);
  SuiteResult result;
  result.settings = settings;
  result.comparisons = family_of(plan, settings);
  result.interrupted = true;  // until all is done
  Counter counter(plan.parts(), watch);
  const auto finish_part = [&] {
    counter.finish_part();
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (keep) keep(result);
  };
  CaseSettings case_settings{settings.backends, settings.effort, settings.seed, 32, settings.rule,
                             std::max<std::size_t>(result.comparisons, 1),
                             // to compile kernels for every scene would take most of a quick run's time
                             settings.effort != Effort::kQuick};
  for (const Case& c : plan.cases) {
    if (watch.stopped()) break;
    say(c.name);
    result.cases.push_back(run_case(c, case_settings, counter.part()));
    finish_part();
  }
  for (const auto& [hard, backend] : plan.hard_cases) {
    if (watch.stopped()) break;
    say("hard/" + hard->name + " on " + backend);
    HardCaseResult figures = run_hard_case(*hard, backend, settings, watch);
    if (watch.stopped()) break;  // of images that were not finished
    result.hard_cases.push_back(std::move(figures));
    finish_part();
  }
  bound_statistical_figures(result.hard_cases);
  for (const ConvergenceCase& c : plan.convergence) {
    if (watch.stopped()) break;
    say(c.name);
    result.convergence.push_back(run_convergence(
        c, {settings.backends, settings.effort, settings.seed, plan.convergence.size()}, counter.part()));
    finish_part();
  }
  if (!plan.mitsuba.empty() && !watch.stopped()) {
    say("mitsuba");
    result.mitsuba = run_mitsuba(*settings.mitsuba, mitsuba_run(plan, settings), counter.part());
    finish_part();
  }
  result.interrupted = watch.stopped();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace kiloband::validation
