// The sigmoid against its formula.
#include "shared/spectrum_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

TEST(Sigmoid, MatchesItsFormula) {
  for (double v = -50; v <= 50; v += 0.37)
    EXPECT_NEAR(kb_sigmoid(static_cast<float>(v)), 0.5 + v / (2 * std::sqrt(1 + v * v)), 2e-7);
  EXPECT_EQ(kb_sigmoid(0.0f), 0.5f);
}

TEST(Sigmoid, IsFiniteForAnyArgument) {
  for (const float v : {1e10f, 1e20f, 3e38f, INFINITY}) {
    EXPECT_EQ(kb_sigmoid(v), 1.0f);
    EXPECT_EQ(kb_sigmoid(-v), 0.0f);
  }
}

}  // namespace
