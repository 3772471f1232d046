// Tails and quantiles against printed tables.
#include "stats/distributions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "stats/random.hpp"
#include "tests/unit/stats/support.hpp"

namespace kiloband::stats::distributions_test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(Distributions, StudentOfTheTables) {
  EXPECT_NEAR(student_upper(0.025, 30), 2.042272, 1e-6);
  EXPECT_NEAR(student_upper(0.005, 4), 4.604095, 1e-6);
  EXPECT_NEAR(student_upper(0.025, kInfinite), 1.959964, 1e-6);
  EXPECT_NEAR(student_p(2.042272, 30), 0.05, 1e-7);
  EXPECT_NEAR(student_p(-2.042272, 30), 0.05, 1e-7);
  EXPECT_EQ(student_p(0, 5), 1);
  EXPECT_EQ(student_p(kInfinite, 5), 0);
  EXPECT_NEAR(student_p(1, 1), 0.5, 1e-15) << "Cauchy";
  EXPECT_NEAR(student_p(3, 2), 1 - 3 / std::sqrt(11.0), 1e-14) << "two degrees: 1 - t / sqrt(2 + t^2)";
  EXPECT_NEAR(student_p(6, kInfinite) / 1.973175e-9, 1, 1e-6);
}

/// Where closed forms are known: one degree of freedom (2 / pi atan(1 / t)) and two.
TEST(Distributions, StudentFarOut) {
  for (const double t : {1e-3, 0.1, 1.0, 30.0, 1e6, 1e60, 1e140}) {
    const double root = std::sqrt(2 + t * t), two = 2 / (root * (root + t));  // 1 - t / root
    EXPECT_NEAR(student_p(t, 1) / (2 / std::numbers::pi * std::atan(1 / t)), 1, 1e-12) << t;
    EXPECT_NEAR(student_p(t, 2) / two, 1, 1e-12) << t;
  }
  for (const double p : {1e-290, 1e-200, 1e-61, 1e-59, 1e-20, 0.01}) {
    EXPECT_NEAR(student_upper(p, 1) * std::tan(std::numbers::pi * p), 1, 1e-12) << p;
    for (const double dof : {3.0, 4.7, 7.0, 15.0, 62.0, 1e4})
      EXPECT_NEAR(student_p(student_upper(p / 2, dof), dof) / p, 1, 1e-8) << p << " " << dof;
  }
}

TEST(Distributions, QuantilesInvert) {
  for (const double p : {1e-9, 1e-3, 0.2}) {
    for (const double dof : {3.0, 31.7, 62.0})
      EXPECT_NEAR(student_p(student_upper(p / 2, dof), dof) / p, 1, 1e-8);
  }
}

/// One side alone is Student's law, two of infinitely many degrees the normal one; sides in between by the
/// tables of Sukhatme (5 % for 6 and 12 degrees: 2.301 where the error is half of each side's), and never
/// below Welch's p.
TEST(Distributions, BehrensAndFisher) {
  constexpr double kMany = std::numeric_limits<double>::infinity();
  for (const double t : {0.5, 3.0, 40.0, 1e6}) {
    for (const double dof : {1.0, 2.0, 15.0}) {
      EXPECT_NEAR(behrens_fisher_p(t, 1, dof, 31) / student_p(t, dof), 1, 1e-6) << t << " " << dof;
      EXPECT_NEAR(behrens_fisher_p(-t, 0, 31, dof) / student_p(t, dof), 1, 1e-6) << t << " " << dof;
      EXPECT_NEAR(behrens_fisher_p(t, 1, dof, kMany) / student_p(t, dof), 1, 1e-6) << t << " " << dof;
    }
  }
  EXPECT_NEAR(behrens_fisher_p(5, 0.3, kMany, kMany) / student_p(5, kMany), 1, 1e-5);
  EXPECT_NEAR(behrens_fisher_p(2.301, 0.5, 6, 12), 0.05, 2e-4);
  for (const double share : {0.01, 0.2, 0.5, 0.9}) {
    const double welch = 1 / (share * share / 7 + (1 - share) * (1 - share) / 31);
    EXPECT_GT(behrens_fisher_p(6, share, 7, 31), student_p(6, welch)) << share;
  }
  EXPECT_EQ(behrens_fisher_p(kMany, 0.5, 3, 3), 0);
}

/// Found in 90 % of 40000 draws (4.5 standard errors), for few and for many degrees of freedom; of the normal
/// law the shift is a sum of quantiles.
TEST(Distributions, NoncentralShiftIsTheOneOfThePower) {
  Random random(1);
  for (const int dof : {2, 7, 31}) {
    const double t = student_upper(1e-4, dof), shift = noncentral_shift(t, dof, 0.9);
    int found = 0;
    for (int i = 0; i < 40000; ++i) {
      double squares = 0;
      for (int k = 0; k < dof; ++k) squares += std::pow(random.normal(), 2);
      found += random.normal() + shift >= t * std::sqrt(squares / dof);
    }
    EXPECT_NEAR(found, 36000, 4.5 * 60) << dof;
  }
  EXPECT_NEAR(noncentral_shift(4, kInfinite, 0.9), 4 + student_upper(0.1, kInfinite), 1e-5);
}

/// Kolmogorov's critical values (Smirnov 1948); both series meet.
TEST(Distributions, Kolmogorov) {
  EXPECT_NEAR(kolmogorov_p(1.3581), 0.05, 1e-5);
  EXPECT_NEAR(kolmogorov_p(1.6276), 0.01, 2e-6);
  EXPECT_NEAR(kolmogorov_p(0.8276), 0.5, 1e-4);
  EXPECT_NEAR(kolmogorov_p(1 - 1e-12), kolmogorov_p(1 + 1e-12), 1e-11);
  EXPECT_EQ(kolmogorov_p(0), 1);
  double mean = 0;
  for (int i = 0; i < 4000; ++i) mean += kolmogorov_p((i + 0.5) * 1e-3) * 1e-3;
  EXPECT_NEAR(mean, std::sqrt(std::acos(-1.0) / 2) * std::log(2), 1e-6);
}

TEST(Distributions, SidakIsExactForTinyLevels) {
  EXPECT_NEAR(sidak(0.01, 10), 1 - std::pow(0.99, 10), 1e-15);
  EXPECT_NEAR(sidak(1e-20, 1e6) / 1e-14, 1, 1e-12);
  EXPECT_EQ(sidak(0, 100), 0);
  EXPECT_EQ(sidak(1, 100), 1);
}

TEST(Distributions, BinomialTails) {
  EXPECT_NEAR(binomial_p(0, 10, 0.5), 2 / 1024.0, 1e-12);
  EXPECT_NEAR(binomial_p(9, 10, 0.5), 22 / 1024.0, 1e-12);
  EXPECT_EQ(binomial_p(5, 10, 0.5), 1);
}

}  // namespace
}  // namespace kiloband::stats::distributions_test
