// Runs the validation suite over the planted faults: which comparison catches each, and with what p-value.
//
//   run_faults [--quick|--default] [--json FILE] [FAULT]...
//
// Every fault is selected in each backend that has it; the cases follow one another, the one that the fault
// concerns first, until one fails as it would in `kiloband validate` (levels of a whole run, with its
// repetition). Exit code 1 if a fault passes all of them. "none" is a fault too: it must pass.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/json_dump.hpp"
#include "validation/faults/selection.hpp"
#include "validation/faults/table.hpp"
#include "validation/suite/results.hpp"
#include "validation/suite/run_case.hpp"

namespace {

using namespace kiloband;
using namespace kiloband::validation;

constexpr std::size_t kFamily = 200;  // comparisons of a whole run, at least

/// What catches it, or that nothing does.
struct Verdict {
  bool caught = false;
  std::string by;  // case, sides, test
  double first_p = 1, p = 1;
  int cases = 0;
};

/// The case of the suite that has what the zoo's scene has.
std::string concerned_case(const faults::PlantedFault& fault) {
  static const std::map<std::string_view, std::string> kCases{{"diffuse_room", "cornell_box"},
                                                              {"unlimited_depth", "stress/endless"},
                                                              {"prism", "stress/red_glass_ball"},
                                                              {"rough_dispersion", "stress/flint_ball"},
                                                              {"thermal", "stress/hot_gas"},
                                                              {"gases", "stress/hot_gas"},
                                                              {"glasses", "stress/lens_and_glass"},
                                                              {"lenses", "stress/lens_and_glass"},
                                                              {"constant_sky", "stress/lens_and_glass"},
                                                              {"mitchell", "stress/glade"},
                                                              {"meter", "analytic/meter"},
                                                              {"stored_otherwise", "analytic/merged"},
                                                              {"many_lights", "analytic/many_lights"},
                                                              {"bumps", "stress/glade"},
                                                              {"instances", "stress/glade"},
                                                              {"suns", "stress/glade"},
                                                              {"projected_lights", "stress/glade"},
                                                              {"roughness_maps", "stress/glade"},
                                                              {"attributes", "stress/glade"},
                                                              {"principled", "stress/glade"}};
  const auto found = kCases.find(fault.zoo_scene);
  return found == kCases.end() ? "stress/metals_and_lamps" : found->second;
}

/// Closed forms first for code that both backends share.
std::vector<Case> ordered_cases(const faults::PlantedFault& fault, bool shared) {
  const std::filesystem::path root = KILOBAND_SOURCE_DIR;
  std::vector<Case> cases = all_cases({root / "scenes", root / "validation/scenes", {}, {}});
  const std::string first = concerned_case(fault);
  std::ranges::stable_sort(cases, {}, [&](const Case& c) {
    return shared ? (c.closed_form ? 0 : 2) : c.name == first ? 0 : c.closed_form ? 2 : 1;
  });
  if (shared) std::erase_if(cases, [](const Case& c) { return !c.closed_form; });
  return cases;
}

std::string describe(const CaseResult& c, const PairingResult& r) {
  const std::string sides =
      r.pairing.kind == Pairing::Kind::kClosedForm ? r.pairing.a.label() + " / closed form"
      : r.pairing.kind == Pairing::Kind::kPaired   ? "equal seeds"
                                                   : r.pairing.a.label() + " / " + r.pairing.b.label();
  return c.what.name + ", " + sides + ", " +
         (r.invalid_samples > 0 ? "invalid samples" : r.comparison.decisive().name);
}

Verdict run_fault(const faults::PlantedFault* fault, const std::string& selected, Effort effort) {
  const faults::FaultScope scope(selected);
  const bool shared = selected.starts_with("shared:");
  static const faults::PlantedFault kNone{0, "none", faults::kCpu, "", "", "diffuse_room", ""};
  CaseSettings settings{{"cpu", "opencl:dpept-batch"}, effort, 1, 32, kComparisonRule, kFamily, false};
  // A fault of the kernels needs programs of its own: those of one scene are compiled sooner.
  settings.specialised = selected.starts_with("opencl:");
  Verdict verdict;
  for (const Case& c : ordered_cases(fault ? *fault : kNone, shared)) {
    ++verdict.cases;
    const CaseResult result = run_case(c, settings, {});
    for (const PairingResult& r : result.pairings) {
      if (r.passed) continue;
      const double p = r.comparison.decisive().p;
      if (verdict.caught && p >= verdict.p) continue;
      verdict = {true, describe(result, r), r.first_p, p, verdict.cases};
    }
    if (verdict.caught) break;
  }
  return verdict;
}

struct Row {
  std::string selected, description;
  Verdict verdict;
};

void print(const Row& row) {
  fmt::print("{:<32} {:<11} p {:<8.1e} {}\n", row.selected, row.verdict.caught ? "caught" : "NOT CAUGHT",
             row.verdict.p, row.verdict.by);
  std::fflush(stdout);
}

nlohmann::json to_json(const std::vector<Row>& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (const Row& row : rows)
    out.push_back({{"fault", row.selected},
                   {"what", row.description},
                   {"caught", row.verdict.caught},
                   {"by", row.verdict.by},
                   {"first_p", row.verdict.first_p},
                   {"p", row.verdict.p},
                   {"cases", row.verdict.cases}});
  return out;
}

bool wanted(const std::string& selected, const std::vector<std::string>& names) {
  return names.empty() || std::ranges::any_of(names, [&](const std::string& n) {
           return selected.find(n) != std::string::npos;
         });
}

/// "cpu:NAME" and so on, of all faults.
std::vector<std::pair<std::string, const faults::PlantedFault*>> selections() {
  std::vector<std::pair<std::string, const faults::PlantedFault*>> all{{"none", nullptr}};
  for (const faults::PlantedFault& fault : faults::planted_faults()) {
    for (const auto& [bit, prefix] : {std::pair{faults::kCpu, "cpu:"}, std::pair{faults::kOpencl, "opencl:"},
                                      std::pair{faults::kShared, "shared:"}}) {
      if (fault.where & bit) all.emplace_back(prefix + std::string(fault.name), &fault);
    }
  }
  return all;
}

int run(const std::vector<std::string>& arguments) {
  Effort effort = Effort::kQuick;
  std::string json;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--default")
      effort = Effort::kStandard;
    else if (arguments[i] == "--quick")
      effort = Effort::kQuick;
    else if (arguments[i] == "--json" && i + 1 < arguments.size())
      json = arguments[++i];
    else
      names.push_back(arguments[i]);
  }
  std::vector<Row> rows;
  std::size_t wrong = 0;
  for (const auto& [selected, fault] : selections()) {
    if (!wanted(selected, names)) continue;
    Row row{selected, fault ? std::string(fault->description) : "nothing is wrong",
            run_fault(fault, selected, effort)};
    wrong += row.verdict.caught != (fault != nullptr);
    print(row);
    rows.push_back(std::move(row));
  }
  if (!json.empty()) std::ofstream(json) << dump_json(to_json(rows), 1) << "\n";
  fmt::print("{} of {} as they should be\n", rows.size() - wrong, rows.size());
  return wrong == 0 && !rows.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "run_faults: %s\n", error.what());
    return 3;
  }
}
