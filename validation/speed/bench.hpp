// A run of `kiloband bench`: what all cases are given, and where their numbers go.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "validation/speed/record.hpp"
#include "validation/suite/rendering.hpp"

namespace kiloband::speed {

using validation::Watch;

struct Settings {
  bool quick = false;
  uint64_t seed = 1;
  std::filesystem::path root;             // kiloband's source folder, absolute
  std::filesystem::path data;             // of public inputs; empty: none
  std::filesystem::path output;           // folder of the results
  std::filesystem::path program;          // kiloband itself
  std::optional<std::string> device;      // of OpenCL
  std::optional<uint64_t> device_memory;  // bytes, for the case `pool`
  std::vector<std::string> backends;      // that take part: "cpu", "opencl:dpept-batch" ...
  bool opencl() const;                    // one of them is OpenCL's
};

/// Cases are functions of this.
class Bench {
 public:
  Bench(const Settings& settings, const Watch& watch) : settings_(settings), watch_(watch) {}

  const Settings& settings() const { return settings_; }
  bool quick() const { return settings_.quick; }
  template <class T>
  T pick(T quick, T full) const {
    return settings_.quick ? quick : full;
  }

  bool stopped() const { return watch_.stopped(); }
  const Watch& watch() const { return watch_; }
  /// How far the case is.
  void progress(double fraction) const {
    if (watch_.progress) watch_.progress(fraction);
  }

  void add(Record record) { records_.push_back(std::move(record)); }
  const std::vector<Record>& records() const { return records_; }

 private:
  Settings settings_;
  Watch watch_;
  std::vector<Record> records_;
};

struct Case {
  std::string name;
  std::string what;    // it measures, in a line
  double quick, full;  // its share of a run's time, roughly in seconds
  void (*run)(Bench& bench);
};

/// In the order in which they run.
const std::vector<Case>& cases();

/// Those whose names are given; all where none is.
/// throws InputError  no such case
std::vector<Case> chosen_cases(const std::vector<std::string>& names);

void run_channels(Bench& bench);
void run_pool(Bench& bench);
void run_memory(Bench& bench);
void run_refraction(Bench& bench);
void run_error(Bench& bench);
void run_stages(Bench& bench);
void run_peers(Bench& bench);
void run_split(Bench& bench);

/// The case's records, and where it failed why.
struct CaseOutcome {
  std::string name;
  std::vector<Record> records;
  double seconds = 0, load_before = 0;  // load: average of the last minute
  bool complete = false;
  std::string failure;
};

struct RunOutcome {
  std::vector<CaseOutcome> cases;
  double seconds = 0;
  bool interrupted = false;
  bool failed() const;  // a case did
};

/// One case after the other; a case that fails leaves the others alone.
/// begun: called with each case's name; kept: with what there is whenever one is done, as an interrupted run
RunOutcome run_cases(const std::vector<Case>& cases, const Settings& settings, const Watch& watch,
                     const std::function<void(const std::string& name)>& begun,
                     const std::function<void(const RunOutcome& run)>& kept = {});

/// bench.csv and bench.json, whole or not at all.
/// machine: machine_json()
void write_results(const std::filesystem::path& folder, const RunOutcome& run, const Settings& settings,
                   const nlohmann::ordered_json& machine);
/// Makes the folder, and removes what an earlier run left there under these names, but not its references.
/// throws DeviceError
void prepare_folder(const std::filesystem::path& folder);

/// Processor, instruction set, threads, memory, OpenCL device, version, commit, date.
nlohmann::ordered_json machine_json(const Settings& settings, const std::string& version);
double load_average();

}  // namespace kiloband::speed
