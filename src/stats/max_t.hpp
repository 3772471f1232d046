// The largest |t| among the channels of a unit, and how often chance alone makes one as large.
//
// All channels of a path share its decisions, so their t are far from independent and K tests at level
// alpha / K would give power away. Westfall and Young (1993) take the joint distribution from the data: flip
// the signs of the replicates (or permute their labels), compute max |t| again. Here a whole run is tested at
// 1e-4, thousands of units at 1e-9 each; no number of permutations that anybody waits
// for resolves that. Therefore
//  * random rotations in the space of the replicates instead of sign flips, of which these are a finite
//    subset (Langsrud, Statistics and Computing 15, 2005): exact for normal replicate means, whatever the
//    correlation of the channels;
//  * the tail by importance sampling (Naiman, Priebe, J. Comp. Graph. Stat. 10, 2001). With
//    A_c = {|t_c| >= t} under rotation and S = number of channels with |t_c| >= t,
//        P(max |t| >= t) = sum_c P(A_c) E[1 / S | A_c] = K p E[1 / S | A_c, c uniform],
//    where p is Student's tail: the Bonferroni bound K p times a factor in [1 / K, 1] that some hundred draws
//    give within percents, for any p.
// A rotation turns the n rows of a channel (x_c, a vector in R^n) against a random direction g: t_c is a
// function of the cosine of g and x_c. Given A_c the cosine with x_c is drawn from its tail, the rest of g is
// uniform. Against the permutations themselves: tests/unit/stats/max_t_test.cpp, validation/README.md.
//
// Two sides that scatter unlike: x_c lives in the replicates of the side that carries the variance, so the
// cosine's tail is that of the channel's own degrees of freedom (Welch's), not of all R_A + R_B - 2. The
// cones of these were too wide, took in channels that never pass together, and raised 4 to 9 times the
// false alarms where 2 or 3 replicates carry the variance against 32. Channels that differ in degrees of
// freedom by more than a quarter follow no common rotation: S does not count them together. A smaller S
// only moves p towards the Bonferroni bound. Measured for sides of 2 to 32 replicates, ratios of scatter
// from 0.1 to 4, 20 or 40 channels of correlation 0 to 0.95, also with a noisy side that changes from
// channel to channel: at levels of 5 % and 1 % at most 0.97 times as many false alarms.
#pragma once

#include <cstdint>
#include <vector>

#include "stats/contrast.hpp"

namespace kiloband::stats {

/// The channel of a unit that speaks most against equality.
struct Strongest {
  std::size_t channel = 0;
  double t = 0;
  double p = 1;              // Student's, of this channel alone; Contrast::p is not smaller
  std::size_t tested = 0;    // channels that vary
  std::size_t constant = 0;  // channels that do not: they must be equal
};

/// wanted: channels to look at; empty: all.
Strongest strongest_channel(const Contrast& contrast, const std::vector<bool>& wanted);

inline constexpr int kRotations = 256;

/// The p-value of the unit: max |t| over the wanted channels.
/// Without rows (variances alone) the Bonferroni bound.
double max_t_p(const Contrast& contrast, const std::vector<bool>& wanted, const Strongest& strongest,
               uint64_t seed);

/// The same by `permutations` random divisions of all replicates into sides of the given sizes (an exact test
/// where both sides have one distribution): (1 + hits) / (1 + permutations).
/// What max_t_p is measured against.
double label_permutation_p(const UnitSample& a, const UnitSample& b, int permutations, uint64_t seed);

}  // namespace kiloband::stats
