#include "stats/family.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/non_central_t.hpp>
#include <vector>

#include "stats/detectable.hpp"
#include "stats/distributions.hpp"

namespace kiloband::stats::family_test {
namespace {

TEST(Family, TheRunFailsAtTheProductOfTheStages) {
  EXPECT_DOUBLE_EQ(RepeatRule{}.overall(), 1e-4);
  EXPECT_DOUBLE_EQ(case_level(1e-2, 50), 2e-4);
}

TEST(Family, AFailureIsRepeatedOnce) {
  EXPECT_EQ(next_stage(true, 0), Stage::kPassed);
  EXPECT_EQ(next_stage(false, 0), Stage::kRepeat);
  EXPECT_EQ(next_stage(true, 1), Stage::kPassed);
  EXPECT_EQ(next_stage(false, 1), Stage::kFailed);
}

TEST(Family, TheRepetitionHasFreshSeeds) {
  for (uint64_t seed = 0; seed < 1000; ++seed) {
    EXPECT_NE(repeat_seed(seed), seed);
    EXPECT_NE(repeat_seed(seed), repeat_seed(seed + 1));
  }
}

/// MDB = delta SE + slack: the noncentral t with that shift is above t(1 - level / 2 tests) with probability
/// 0.9.
TEST(Detectable, ByHand) {
  DetectableBias errors;
  errors.add({0.01f, 0, 30, 0}, {0.02f, 0.001f, 30, 3});
  errors.add({0.02f, 0, 30, 1}, {0.03f, 0, 30, 2});
  errors.add({0.04f, 0, 30, 1}, {0.05f, 0, 30, 2});
  const Detectable d = errors.at(0.05, 1);
  const double shift = d.best / 0.01, critical = 2.042272;  // table: 97.5 %, 30 degrees of freedom
  EXPECT_NEAR(boost::math::cdf(boost::math::complement(boost::math::non_central_t(30, shift), critical)), 0.9,
              1e-5);
  EXPECT_NEAR(d.typical, 0.02 * shift, 1e-7);
  EXPECT_NEAR(d.largest, 0.05 * shift, 1e-7);
  EXPECT_EQ(d.largest_channel, 2u);
  EXPECT_GT(errors.at(0.05, 1000).best, d.best);
}

/// The worst is the largest bias, not the largest error: 4 replicates need a far larger t than 32.
TEST(Detectable, TheWorstIsThatOfTheLargestBias) {
  const RelativeError few{0.09f, 0, 3, 0, 1, 3, 31}, many{0.1f, 0, 31, 1, 0, 3, 31}, middle{0.02f, 0, 30, 2};
  const auto at = [](const std::vector<RelativeError>& values) {
    DetectableBias errors;
    for (const RelativeError& value : values) errors.add(value, value);
    return errors.at(1e-3, 8192);
  };
  ASSERT_GT(at({few}).largest, 10 * at({many}).largest);
  const Detectable all = at({middle, few, many});
  EXPECT_EQ(all.largest, at({few}).largest);
  EXPECT_EQ(all.largest_channel, 0u);
}

}  // namespace
}  // namespace kiloband::stats::family_test
