// What a validation run writes: results.json (everything that the report shows), junit.xml, and cubes.
//
//   DIR/results.json
//   DIR/junit.xml
//   DIR/cubes/CASE/SIDE.hdr (ENVI, mean and variance of every pixel): the first side of each case, and both
//                           sides of every comparison that failed; names in results.json
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "validation/suite/suite.hpp"

namespace kiloband::validation {

/// Where and with what a run was done; recorded as it is.
struct RunRecord {
  std::string program, processor, date;
  std::vector<std::string> backends;  // "opencl:pt on DEVICE"
};

/// Numbers that are not finite become null, infinite ones of maps 1e30.
nlohmann::json to_json(const SuiteResult& result, const RunRecord& record);

/// A test case per comparison, hard case, convergence study and scene against Mitsuba; failures with the
/// deciding test; an interrupted run is an error.
std::string to_junit(const SuiteResult& result);

/// To be called before a run: makes the folder and removes what an earlier run has left there (reports and
/// verdicts, not cubes), so that it is not taken for this run's.
/// throws DeviceError  the folder cannot be written to
void prepare_results(const std::filesystem::path& directory);

/// results.json and junit.xml alone.
/// throws DeviceError  a file cannot be written
void write_verdicts(const std::filesystem::path& directory, const SuiteResult& result,
                    const RunRecord& record);

/// Writes all of it, the cubes too.
/// throws DeviceError  a file cannot be written
void write_results(const std::filesystem::path& directory, const SuiteResult& result,
                   const RunRecord& record);

/// File name of a case's side without extension, relative to the directory of the results.
std::string cube_name(const CaseResult& c, const SideImage& side);

}  // namespace kiloband::validation
