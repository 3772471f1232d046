// hard_cases BACKEND quick|standard|thorough [CASE]...: runs the hard cases and prints one line per figure,
// as a table in Markdown. Exit code 1 if a figure is beyond its limit, 2 for a wrong command line.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "validation/suite/hard_cases/hard_cases.hpp"

namespace {

using namespace kiloband::validation;

bool print(const HardCase& one, const HardCaseContext& context) {
  bool pass = true;
  for (const HardFigure& f : one.run(context)) {
    pass = pass && f.pass;
    fmt::print("| {} | {} | {} | {:.9g} | {:.9g} | {:.2g} | {:.2g} | {}{} |\n", one.name, context.backend,
               f.name, f.value, f.reference, f.error, f.limit, f.pass ? "" : "FAILS; ", f.note);
    std::fflush(stdout);
  }
  return pass;
}

}  // namespace

int main(int argc, char** argv) {
  static const std::map<std::string, Effort> kEfforts{
      {"quick", Effort::kQuick}, {"standard", Effort::kStandard}, {"thorough", Effort::kThorough}};
  if (argc < 3 || !kEfforts.contains(argv[2])) {
    fmt::print(stderr,
               "usage: hard_cases cpu|opencl:dpept-batch|opencl:dpept-path|opencl:pt "
               "quick|standard|thorough [CASE]...\n");
    return 2;
  }
  HardCaseContext context{argv[1], kEfforts.at(argv[2])};
  const std::vector<std::string> wanted(argv + 3, argv + argc);
  fmt::print(
      "| case | backend | figure | value | reference | error | limit | note "
      "|\n|---|---|---|---|---|---|---|---|\n");
  bool pass = true;
  for (const HardCase& one : hard_cases()) {
    if (!wanted.empty() && std::ranges::find(wanted, one.name) == wanted.end()) continue;
    pass = print(one, context) && pass;
  }
  return pass ? 0 : 1;
}
