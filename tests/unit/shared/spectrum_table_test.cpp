// Lookup in regular tables, and sigmoids.
#include "shared/spectrum_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

// Entries 5 to 8 of the array: 400, 410, 420, 430 nm.
const std::vector<float> kValues{-1, -1, -1, -1, -1, 2, 4, 3, 7, -1, -1};

KbSpectrumTable table(uint32_t count, bool extrapolate) {
  return {400.0f, 0.1f, 5, count, extrapolate ? 1u : 0u, 0};
}

float value(uint32_t count, bool extrapolate, float lambda_nm) {
  return kb_table_value(kValues.data(), table(count, extrapolate), lambda_nm);
}

TEST(SpectrumTable, InterpolatesLinearly) {
  EXPECT_EQ(value(4, false, 400), 2.0f);
  EXPECT_EQ(value(4, false, 410), 4.0f);
  EXPECT_EQ(value(4, false, 430), 7.0f);
  EXPECT_NEAR(value(4, false, 405), 3.0f, 1e-6);
  EXPECT_NEAR(value(4, false, 412.5f), 3.75f, 1e-5);
  EXPECT_NEAR(value(4, false, 429.9f), 6.96f, 1e-4);
}

TEST(SpectrumTable, IsZeroOrConstantOutside) {
  for (const float lambda_nm : {0.0f, 399.9f, 430.1f, 20'000.0f}) {
    EXPECT_EQ(value(4, false, lambda_nm), 0.0f);
    EXPECT_EQ(value(4, true, lambda_nm), lambda_nm < 400 ? 2.0f : 7.0f);
  }
}

TEST(SpectrumTable, HandlesTablesOfOneEntry) {
  EXPECT_EQ(value(1, false, 400), 2.0f);
  EXPECT_EQ(value(1, false, 401), 0.0f);
  EXPECT_EQ(value(1, true, 9000), 2.0f);
}

TEST(SpectrumTable, PositionStaysInsideTheTable) {
  for (float lambda_nm = 350; lambda_nm < 480; lambda_nm += 0.37f) {
    const KbTablePosition p = kb_table_position(table(4, true), lambda_nm);
    EXPECT_LE(p.index, 2u);
    EXPECT_GE(p.fraction, 0.0f);
    EXPECT_LE(p.fraction, 1.0f);
  }
}

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

TEST(Sigmoid, TexelsAreHeldOutsideTheCieRange) {
  const KbFloat4 flat{0, 0, 1e10f, 0.25f};
  for (const float lambda_nm : {300.0f, 500.0f, 10'000.0f}) EXPECT_EQ(kb_texel_value(flat, lambda_nm), 0.25f);
  const KbFloat4 slope{0, 0.01f, -5, 2};
  EXPECT_EQ(kb_texel_value(slope, 500), 1.0f);
  EXPECT_EQ(kb_texel_value(slope, 200), kb_texel_value(slope, 360));
  EXPECT_EQ(kb_texel_value(slope, 12'000), kb_texel_value(slope, 830));
  EXPECT_NEAR(kb_texel_value(slope, 600), 1 + 1 / std::sqrt(2.0), 1e-6);
}

}  // namespace
