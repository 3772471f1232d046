// Numerical stability on hard cases: scenes at the ends of what numbers, sizes and path lengths may be, each
// with figures that say how far a backend is from a closed form or from the double-precision oracle.
//
// A case names no backend: the context does. Where the estimator has no variance, errors are of rounding and
// each limit has its reason beside it; where it has, the limit is a t-quantile times the standard error of
// the mean over replicates. All statistical figures of a run together raise a false alarm with probability
// kHardFamilyRate at most (Bonferroni over kHardStatisticalFigures on kMostBackends).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "validation/suite/effort.hpp"
#include "validation/suite/error_rates.hpp"
#include "validation/suite/rendering.hpp"

namespace kiloband::validation {

/// Upper bound of the statistical figures of all cases on one backend.
inline constexpr std::size_t kHardStatisticalFigures = 100;

struct HardCaseContext {
  std::string backend = "cpu";  // or "opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"
  Effort effort = Effort::kQuick;
  uint64_t seed = 1;
  Watch watch;  // once it is stopped, figures are of unfinished images and mean nothing
};

/// One number. error and limit are in `unit`, as value and reference are, unless the note says otherwise.
struct HardFigure {
  std::string name, unit;
  double value = 0, reference = 0, error = 0, limit = 0;
  bool pass = false;
  bool statistical = false;
  std::string note;  // standard error and detectable bias, or why the limit is what it is
};

struct HardCase {
  std::string name, what;
  std::function<std::vector<HardFigure>(const HardCaseContext&)> run;
};

/// All cases, in the order in which they are reported.
const std::vector<HardCase>& hard_cases();

}  // namespace kiloband::validation
