// How the error falls with samples and with seconds, per backend, method, sampler and wavelength mode.
//
// Error of an N-sample image without any reference: R images of N samples with independent random numbers
// scatter about their mean with the variance of one such image, so for pixel p and channel c
//     s^2(p, c) = 1 / (R - 1) sum_r (m_r - m)^2,
//     rms relative error = sqrt(mean_{p,c} s^2 / (mean of the image)^2),
// unbiased in s^2 whatever the sampler, as long as replicates are independent (they are). The slope is the
// least squares line of ln error over ln N, weighted equally;
// its standard error comes from the jackknife over replicates.
#pragma once

#include <string>
#include <vector>

#include "validation/suite/case.hpp"

namespace kiloband::validation {

struct ConvergencePoint {
  uint32_t samples = 0;  // of one image, per pixel
  double relative_error = 0;
  double seconds = 0;  // of one image of that many samples
  /// 1 / (relative error^2 times seconds): what a second buys.
  double efficiency() const { return 1 / (relative_error * relative_error * seconds); }
};

struct ConvergenceCurve {
  Configuration configuration;
  std::vector<ConvergencePoint> points;
  double slope = 0, slope_error = 0, slope_dof = 0;
  uint64_t invalid_samples = 0;  // a pass has none
};

struct ConvergenceResult {
  std::string name;
  std::vector<ConvergenceCurve> curves;
  bool passed = true;        // every curve of independent samples has the slope -1/2 within its error
  bool interrupted = false;  // the run was stopped before all curves were measured
  std::string note;
};

struct ConvergenceCase {
  std::string name;
  CaseScene scene;
  ByEffort<uint32_t> most_samples;
};

std::vector<ConvergenceCase> convergence_cases(const SceneFolders& folders);

struct ConvergenceSettings {
  std::vector<std::string> backends;
  Effort effort = Effort::kStandard;
  uint64_t seed = 1;
  std::size_t cases = 1;  // of the run: kConvergenceRate is that of all their known slopes
};

/// What is thrown (a backend that cannot work) is its failure, in the note.
ConvergenceResult run_convergence(const ConvergenceCase& c, const ConvergenceSettings& settings,
                                  const Watch& watch);

}  // namespace kiloband::validation
