// A whole validation run: cases, hard cases, convergence, an independent renderer;
// one family-wise error rate.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "validation/suite/convergence.hpp"
#include "validation/suite/error_rates.hpp"
#include "validation/suite/hard_cases/hard_cases.hpp"
#include "validation/suite/mitsuba.hpp"
#include "validation/suite/run_case.hpp"

namespace kiloband::validation {

struct SuiteSettings {
  std::vector<std::string> names;  // of cases and sections (beginnings do); empty: all
  std::vector<std::string> backends{"cpu"};
  Effort effort = Effort::kStandard;
  uint64_t seed = 1;
  SceneFolders folders;
  stats::RepeatRule rule = kComparisonRule;
  std::optional<MitsubaDriver> mitsuba;   // none: no case against Mitsuba
  std::filesystem::path program, output;  // for it: kiloband itself, the folder of the results
};

struct HardCaseResult {
  std::string name, what, backend;
  std::vector<HardFigure> figures;
  bool passed = false;
  std::string error;
};

struct SuiteResult {
  SuiteSettings settings;
  std::vector<CaseResult> cases;
  std::vector<HardCaseResult> hard_cases;
  std::vector<ConvergenceResult> convergence;
  MitsubaResult mitsuba;
  std::size_t comparisons = 0;  // the family
  double seconds = 0;
  bool interrupted = false;

  /// Nothing failed, and all was run.
  bool passed() const;
};

/// What a run will do, and the errors, as run_suite(): names of cases, "hard/...",
/// "convergence/..." and "mitsuba/...".
std::vector<std::string> planned_names(const SuiteSettings& settings);

/// The rate of false alarms is divided over kHardStatisticalFigures of a backend: the case whose figures are
/// beyond that many has failed.
void bound_statistical_figures(std::vector<HardCaseResult>& hard_cases);

/// `say` is told when something begins; watch.progress: fraction of the whole run. `keep` gets what there is whenever a case is done, as
/// an interrupted run: a process that is ended while a driver compiles, which no signal gets through to, leaves that behind.
/// What a case throws is its failure, and the run goes on.
/// throws InputError  a name of none of the cases that there are with these settings
SuiteResult run_suite(const SuiteSettings& settings, const Watch& watch,
                      const std::function<void(const std::string&)>& say,
                      const std::function<void(const SuiteResult&)>& keep = {});

}  // namespace kiloband::validation
