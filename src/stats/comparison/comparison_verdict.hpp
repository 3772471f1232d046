// From the results of the tests to the verdict (comparison.hpp).
#pragma once

#include "stats/comparison/comparison.hpp"

namespace kiloband::stats {

/// Tests that share alpha, at most: no test's level is below alpha / kMostTests.
inline constexpr double kMostTests = 9;

/// Whether the replicates of both sides hold the same number of samples, as tests of variances need: to one
/// sample within a side, whose samples may not divide by its replicates; to 1e-3 in the mean between the
/// sides.
bool replicates_have_same_sizes(const UnitSample& a, const UnitSample& b);

/// Means of the whole image.
void add_image_means(const Contrast& contrast, Comparison& comparison);

/// Against a truth, before uniformity: drops the scales at which the noise is too skewed for Student's law.
void leave_out_skewed(Comparison& comparison);

/// Whether a test of means or variances has p below the level, or a value is not finite.
bool is_different(const Comparison& comparison, double level);

/// Lists the tests with their levels, the notes, and whether all passed. Tests that saw nothing are named in
/// a note and take no share of alpha.
/// throws InputError  none saw anything, and nothing is not finite
void judge(Comparison& comparison, const ComparisonOptions& options, bool same_sizes);

}  // namespace kiloband::stats
