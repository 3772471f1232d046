// What a run's rate of false alarms is made of. The parts are added (Bonferroni: nothing is assumed about
// their dependence), so a whole run of a program without faults fails with probability kRunRate at most.
#pragma once

#include "stats/family.hpp"

namespace kiloband::validation {

inline constexpr double kRunRate = 1e-4;

/// The CPU backend and the three OpenCL methods.
inline constexpr int kMostBackends = 4;

/// All comparisons of all cases together; what fails is repeated once.
inline constexpr stats::RepeatRule kComparisonRule{1e-2, 5e-3};
/// All statistical figures of the hard cases, on all backends.
inline constexpr double kHardFamilyRate = 3e-5;
/// All slopes that are known.
inline constexpr double kConvergenceRate = 1e-5;
/// All scenes against Mitsuba, on all backends.
inline constexpr double kMitsubaRate = 1e-5;

static_assert(kComparisonRule.overall() + kHardFamilyRate + kConvergenceRate + kMitsubaRate <=
              kRunRate * (1 + 1e-12));

}  // namespace kiloband::validation
