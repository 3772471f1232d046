// Mitsuba 3 as an independent renderer of the same scenes: validation/mitsuba/compare_with_mitsuba.py, run as
// a child process and read back. It is optional and looked for when a run begins.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "validation/suite/child_process.hpp"
#include "validation/suite/effort.hpp"
#include "validation/suite/rendering.hpp"

namespace kiloband::validation {

/// Where it is looked for.
struct MitsubaSearch {
  std::vector<std::string> interpreters{"python3", "/usr/bin/python3"};
  std::filesystem::path script;  // compare_with_mitsuba.py
};

/// An interpreter in which the script finds numpy, SciPy and Mitsuba.
struct MitsubaDriver {
  std::string interpreter, version;
  std::filesystem::path script;
  std::vector<std::string> scenes;  // "cornell_box"
};

/// One scene on one backend.
struct MitsubaScene {
  std::string name, backend;
  bool passed = false;
  std::string failure;   // why it did not pass
  nlohmann::json entry;  // all that mitsuba.json has of it; null: nothing

  /// "/detectable/typical" of the entry; NaN where there is no such number.
  double figure(const char* pointer) const;
};

struct MitsubaResult {
  nlohmann::json record;  // what mitsuba.json says of all scenes: versions, rate, date
  std::vector<MitsubaScene> scenes;
  bool passed() const;
};

struct MitsubaRun {
  std::filesystem::path program, output;  // kiloband itself; the folder of the results
  std::vector<std::string> scenes, backends;
  Effort effort = Effort::kStandard;
  uint64_t seed = 1;
};

/// Whether a run of these names has cases "mitsuba/SCENE", if Mitsuba is there. A quick run has none.
bool wants_mitsuba(const std::vector<std::string>& names, Effort effort);

/// The first interpreter that has Mitsuba; nothing where the run does not want it or none has it.
/// throws InputError  a name begins with "mitsuba" and there will be no such case
std::optional<MitsubaDriver> find_mitsuba(const MitsubaSearch& search, const std::vector<std::string>& names,
                                          Effort effort);

/// Those that are compared: all in a thorough run, else the first of the CPU and the first of OpenCL (the
/// methods give one image: tests/statistical/backends).
std::vector<std::string> mitsuba_backends(const std::vector<std::string>& backends, Effort effort);

/// Writes OUTPUT/mitsuba.json and OUTPUT/mitsuba. What the script could not do has failed, with the reason.
MitsubaResult run_mitsuba(const MitsubaDriver& driver, const MitsubaRun& run, const Watch& watch);

/// text: mitsuba.json, empty if there is none. Every scene of the run on every backend, in this order; those
/// that are missing have failed, for `end` says why, or are left out if it was stopped.
MitsubaResult read_mitsuba(const std::string& text, const MitsubaRun& run, const ChildEnd& end);

}  // namespace kiloband::validation
