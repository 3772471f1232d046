// Differences and their variances against arithmetic by hand and against the film's own moments.
#include "stats/contrast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "film/statistics.hpp"
#include "stats/distributions.hpp"

namespace kiloband::stats::contrast_test {
namespace {

UnitSample one_channel(std::vector<double> values) {
  const std::size_t count = values.size();
  return {1, std::move(values), std::vector<double>(count, 1.0)};
}

/// Means 2.5 and 6, variances of the mean (5/3)/4 and 10/5.
TEST(Contrast, WelchByHand) {
  const Contrast c = independent_contrast(one_channel({1, 2, 3, 4}), one_channel({2, 4, 6, 8, 10}), 0);
  const double va = 5.0 / 12, vb = 2;
  EXPECT_DOUBLE_EQ(c.difference[0], -3.5);
  EXPECT_NEAR(c.variance[0], va + vb, 1e-15);
  EXPECT_NEAR(c.t(0), -3.5 / std::sqrt(va + vb), 1e-14);
  EXPECT_NEAR(c.dof[0], (va + vb) * (va + vb) / (va * va / 3 + vb * vb / 4), 1e-12);
}

TEST(Contrast, PairsAreDifferences) {
  const Contrast c = paired_contrast(one_channel({1, 2, 3, 4}), one_channel({2, 2, 2, 8}), 0);
  EXPECT_DOUBLE_EQ(c.difference[0], -1);  // of -1, 0, 1, -4
  EXPECT_NEAR(c.variance[0], 14.0 / 3 / 4, 1e-15);
  EXPECT_EQ(c.dof[0], 3);
  EXPECT_THROW(paired_contrast(one_channel({1, 2}), one_channel({1, 2, 3}), 0), std::logic_error);
}

TEST(Contrast, TruthWithABound) {
  const UnitSample a = one_channel({1, 2, 3, 4});
  const Contrast exact = truth_contrast(a, {{2}, {}}, 0);
  EXPECT_NEAR(exact.t(0), 0.5 / std::sqrt(5.0 / 12), 1e-14);
  EXPECT_NEAR(truth_contrast(a, {{2}, {0.2}}, 0).t(0), 0.3 / std::sqrt(5.0 / 12), 1e-14);
  EXPECT_EQ(truth_contrast(a, {{2}, {0.6}}, 0).t(0), 0);
}

/// Unequal replicates, one of them empty: the formula of the film.
TEST(Contrast, UnequalReplicatesAsTheFilmHasThem) {
  const UnitSample a{2, {1, 5, 2, 7, 99, 99, 4, 6, 3, 9}, {3, 2, 0, 1, 4}}, b{2, {0, 0, 0, 0}, {1, 1}};
  ReplicateMoments moments(1, 2, true);
  for (std::size_t r = 0; r < 5; ++r) {
    const std::vector<float> means{static_cast<float>(a.means[2 * r]),
                                   static_cast<float>(a.means[2 * r + 1])};
    moments.add(0, static_cast<uint64_t>(a.weights[r]), means);
  }
  std::vector<float> variance(2);
  moments.variance_of_mean(0, variance);
  const Contrast c = independent_contrast(a, b, 0);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(c.a[k], moments.mean(0)[k], 1e-6);
    EXPECT_NEAR(c.variance[k], variance[k], 1e-6);
    EXPECT_NEAR(c.dof[k], 3, 1e-12) << "four replicates with samples; the other side does not vary";
  }
}

/// No variance: equal up to rounding, or infinitely different. A third of 0.1 is not exact in binary.
TEST(Contrast, ConstantsAreComparedAsTheyAre) {
  const UnitSample a = one_channel({0.1, 0.1, 0.1}), b = one_channel({0.1, 0.1, 0.1});
  const UnitSample near = one_channel({0.1000005, 0.1000005}), far = one_channel({0.1001, 0.1001});
  EXPECT_EQ(independent_contrast(a, b, 0).t(0), 0);
  EXPECT_TRUE(independent_contrast(a, b, 0).constant(0));
  EXPECT_EQ(independent_contrast(a, near, 1e-5).t(0), 0);
  EXPECT_EQ(independent_contrast(a, near, 0).t(0), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(independent_contrast(far, a, 1e-5).t(0), std::numeric_limits<double>::infinity());
}

/// Variances far below the squares of doubles.
TEST(Contrast, TinyValuesDoNotUnderflow) {
  const double unit = 1e-130;
  const Contrast c =
      independent_contrast(one_channel({unit, 2 * unit, 3 * unit, 4 * unit}),
                           one_channel({2 * unit, 4 * unit, 6 * unit, 8 * unit, 10 * unit}), 0);
  EXPECT_NEAR(c.t(0), -3.5 / std::sqrt(29.0 / 12), 1e-12);
  EXPECT_NEAR(c.dof[0], 5.5208, 1e-4);
}

/// No law of two values reaches the bound, which is near the largest.
TEST(Contrast, TheProbabilityOfAgreementByChance) {
  for (const auto& [a, b] : {std::pair{2.0, 2.0}, std::pair{4.0, 4.0}, std::pair{8.0, 8.0},
                             std::pair{2.0, 32.0}, std::pair{3.0, 8.0}}) {
    double most = 0;
    for (double p = 0.001; p < 1; p += 0.001)
      most = std::max(most, std::pow(p, a) * std::pow(1 - p, b) + std::pow(1 - p, a) * std::pow(p, b));
    EXPECT_LE(most, chance_agreement(a, b)) << a << " " << b;
    EXPECT_GE(most, 0.4 * chance_agreement(a, b)) << a << " " << b;
    EXPECT_EQ(chance_agreement(a, b), chance_agreement(b, a));
  }
  EXPECT_EQ(chance_agreement(4, 0), 0.125) << "signs";
  EXPECT_EQ(chance_agreement(16, 16), 0);
  EXPECT_EQ(chance_agreement(std::numeric_limits<double>::infinity(), 2), 0);
}

/// To a float's rounding. A difference of few replicates is no more than that by chance, one of a side that
/// agrees has the degrees of freedom of the poorer.
TEST(Contrast, ReplicatesThatAgreeByChance) {
  const UnitSample two = one_channel({1, 1 + 1e-8}), other = one_channel({0.5, 0.5});
  EXPECT_EQ(independent_contrast(two, other, 1e-5).p(0), chance_agreement(2, 2));
  EXPECT_EQ(independent_contrast(two, two, 1e-5).p(0), 1);
  EXPECT_EQ(truth_contrast(two, {{0.5}, {}}, 1e-5).p(0), 0.5);
  const Contrast c = independent_contrast(two, one_channel({0, 0, 1, 0, 0, 0, 0, 0}), 1e-5);
  EXPECT_NEAR(c.t(0), 7, 1e-3);
  EXPECT_NEAR(c.p(0), student_p(7, 1), 1e-5);
  EXPECT_NEAR(c.dof[0], 7, 1e-6) << "of the noise that there is";
}

TEST(Contrast, OneReplicateIsNone) {
  EXPECT_FALSE(independent_contrast(one_channel({1}), one_channel({1, 2}), 0).valid);
}

TEST(Contrast, ContributionsFromEmptyReplicates) {
  EXPECT_EQ(contributions(one_channel({0, 0, 0}), 0), 0);
  EXPECT_NEAR(contributions(one_channel({0, 1, 0, 2}), 0), 4 * std::log(2), 1e-12);
  EXPECT_TRUE(std::isinf(contributions(one_channel({1, 2}), 0)));
}

}  // namespace
}  // namespace kiloband::stats::contrast_test
