// From the results of the tests to the verdict (comparison.hpp).
#pragma once

#include "stats/comparison/comparison.hpp"

namespace kiloband::stats {

/// Whether the replicates of both sides hold the same number of samples (to one sample),
/// as tests of variances need.
bool replicates_have_same_sizes(const UnitSample& a, const UnitSample& b);

/// Means of the whole image.
void add_image_means(const Contrast& contrast, Comparison& comparison);

/// Against a truth: drops the scales at which the noise is too skewed for Student's law.
void leave_out_skewed(Comparison& comparison);

/// Lists the tests with their levels, the notes, and whether all passed. Tests that saw nothing are named in
/// a note and take no share of alpha.
/// throws InputError  none saw anything, and nothing is not finite
void judge(Comparison& comparison, const ComparisonOptions& options, bool same_sizes);

}  // namespace kiloband::stats
