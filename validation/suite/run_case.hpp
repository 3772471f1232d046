// Runs one case: renders, compares, and repeats what failed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stats/comparison/comparison.hpp"
#include "validation/suite/case.hpp"
#include "validation/suite/error_rates.hpp"

namespace kiloband::validation {

/// What decides about a pairing: the last attempt. Invalid samples and values that are not finite are
/// failures that no repetition takes back.
struct PairingResult {
  Pairing pairing;
  bool passed = false;
  int attempts = 0;                     // 2: the first failed and was repeated
  double level = 0;                     // of the last attempt
  double first_p = 1;                   // smallest p of the first attempt's tests
  uint32_t samples = 0;                 // per pixel and replicate, of the last attempt
  uint64_t invalid_samples = 0;         // of both sides; a pass has none
  double seconds_a = 0, seconds_b = 0;  // of rendering, last attempt
  stats::Comparison comparison;
};

/// The images of a side, for the cubes that explain a failure.
struct SideImage {
  std::string label;
  stats::ReplicateImage image;
};

struct CaseResult {
  Case what;
  std::size_t triangles = 0;
  ChannelList channels;
  uint32_t width = 0, height = 0;
  bool passed = false;
  bool interrupted = false;  // the run was stopped before all comparisons were made
  std::vector<PairingResult> pairings;
  std::vector<SideImage> images;  // of the first side, and of all sides of failed pairings
  std::string error;              // what kept the case from being run: then it has failed
};

struct CaseSettings {
  std::vector<std::string> backends;
  Effort effort = Effort::kStandard;
  uint64_t seed = 1;
  uint32_t replicates = 32;
  stats::RepeatRule rule = kComparisonRule;
  std::size_t family = 1;   // comparisons of the whole run
  bool specialised = true;  // OpenCL kernels compiled for each scene; false: one program for all
};

/// Whatever is thrown (a scene that cannot be read, a backend that cannot work) is the case's failure: the
/// other cases of a run are worth having.
CaseResult run_case(const Case& c, const CaseSettings& settings, const Watch& watch);

}  // namespace kiloband::validation
