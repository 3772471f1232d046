// Error rates of a whole run: levels of its tests, and the rule for repeating what failed.
//
// A run of C cases at the family-wise rate alpha gives each case alpha / C and each of a case's T tests
// alpha / (C T) (Bonferroni: the tests of a case look at the same images, so nothing is known
// of their dependence).
//
// A case that fails is rendered once more, with fresh seeds and kRepeatSamples times the samples, and is
// judged by its second result alone. The two results are independent, so for a program without faults a run
// fails with probability at most
//     sum over cases of first_c * again_c = C * (first / C) * (again / C) <= first * again,
// where `first` and `again` are the family-wise rates of the two stages. With 1e-2 each that is 1e-4
// (1e-4 / C in fact), and one run in a hundred repeats a case. A fault that the first stage sees at t is seen
// at 2 t by the second, so the repetition costs hardly any power, while a single stage at 1e-4 would need a
// bias larger by a seventh to see it at all.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kiloband::stats {

struct RepeatRule {
  double first = 1e-2;  // family-wise rate of the first stage, over all cases
  double again = 1e-2;  // of the second, over all cases as if each were repeated

  constexpr double overall() const { return first * again; }
};

inline constexpr uint64_t kRepeatSamples = 4;

/// Level of one of `cases` cases.
double case_level(double family, std::size_t cases);

/// A seed for the repetition that no other case or stage has.
uint64_t repeat_seed(uint64_t seed);

enum class Stage { kPassed, kRepeat, kFailed };

/// What follows from a case's result. attempt: 0 for the first, 1 for the repetition.
Stage next_stage(bool passed, int attempt);

}  // namespace kiloband::stats
