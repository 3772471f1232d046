// Mitsuba 3 as an independent renderer of the same scenes: a child process per scene (validation/mitsuba/render_mitsuba.py)
// writes its images. It is optional and looked for when a run begins.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "validation/suite/child_process.hpp"
#include "validation/suite/effort.hpp"
#include "validation/suite/mitsuba_comparison.hpp"

namespace kiloband::validation {

/// Where it is looked for.
struct MitsubaSearch {
  std::vector<std::string> interpreters{"python3", "/usr/bin/python3"};
  std::filesystem::path root;  // kiloband's source folder
};

/// An interpreter in which the script finds numpy and Mitsuba.
struct MitsubaDriver {
  std::string interpreter;
  nlohmann::json versions;  // "mitsuba", "variant", "python", "numpy"
  std::filesystem::path script;
  std::vector<MitsubaCase> scenes;
};

struct MitsubaResult {
  nlohmann::json record;  // of all scenes: versions and rate
  std::vector<MitsubaScene> scenes;
  bool passed() const;
};

struct MitsubaRun {
  std::filesystem::path output;  // the folder of the results
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

/// Every scene on every backend, in this order; Mitsuba's cubes are left in OUTPUT/mitsuba. A scene that could not be
/// done has failed, with the reason. What was not finished when the watch stopped it is left out.
MitsubaResult run_mitsuba(const MitsubaDriver& driver, const MitsubaRun& run, const Watch& watch);

}  // namespace kiloband::validation
