// Positions and means of spectra that are given at band centres, against a plain table and brute force.
#include "scene/compile/spectra/band_set.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kiloband::test::band_set_test {
namespace {

BandSet irregular(bool extrapolate = false) {
  BandSet set;
  set.centres_nm = {410, 420, 500, 515, 700};
  set.min_nm = 400;
  set.max_nm = 730;
  set.extrapolate = extrapolate;
  set.scale = 2;
  return set;
}

const std::vector<double> kValues{0.5, 3, 1, 0, 4};

double value_at(const BandSet& set, double nm) {
  const BandPosition p = band_position(set, nm);
  EXPECT_GE(p.fraction, 0);
  EXPECT_LE(p.fraction, 1);
  EXPECT_LT(p.index + 1, set.centres_nm.size());
  if (!p.inside) return 0;
  return set.scale * ((1 - p.fraction) * kValues[p.index] + p.fraction * kValues[p.index + 1]);
}

TEST(BandSet, LinearBetweenCentresConstantToTheEdgesZeroBeyond) {
  const BandSet set = irregular();
  const std::pair<double, double> expected[] = {{399.9, 0}, {400, 1}, {405, 1}, {410, 1},
                                                {415, 3.5}, {420, 6}, {460, 4}, {515, 0},
                                                {607.5, 4}, {700, 8}, {730, 8}, {730.1, 0}};
  for (const auto& [nm, value] : expected) EXPECT_NEAR(value_at(set, nm), value, 1e-12) << nm;
  EXPECT_NEAR(value_at(irregular(true), 300), 1, 1e-12);
  EXPECT_NEAR(value_at(irregular(true), 900), 8, 1e-12);
}

TEST(BandSet, SpectrumAndPositionsAreTheSameFunction) {
  for (const bool extrapolate : {false, true}) {
    const BandSet set = irregular(extrapolate);
    const Spectrum spectrum = band_spectrum(set, kValues);
    for (double nm = 380.25; nm < 760; nm += 0.5) EXPECT_NEAR(spectrum(nm), value_at(set, nm), 1e-12) << nm;
  }
}

TEST(BandSet, OneBand) {
  BandSet set;
  set.centres_nm = {550};
  set.min_nm = 500;
  set.max_nm = 600;
  EXPECT_EQ(band_position(set, 510).index, 0u);
  EXPECT_EQ(band_position(set, 590).fraction, 0);
  EXPECT_FALSE(band_position(set, 600.1).inside);
  std::vector<double> weights(1);
  add_mean_weights(set, {450, 550, ""}, weights);
  EXPECT_NEAR(weights[0], 0.5, 1e-12);
}

/// The weights are means of the tents: the mean of a spectrum is exact,
/// and bands that the channel does not see have 0.
TEST(BandSet, MeanWeights) {
  for (const bool extrapolate : {false, true}) {
    const BandSet set = irregular(extrapolate);
    const Spectrum spectrum = band_spectrum(set, kValues);
    for (const auto& [low, high] : {std::pair{395.0, 745.0},
                                    {412.0, 413.0},
                                    {418.0, 640.0},
                                    {720.0, 800.0},
                                    {300.0, 380.0},
                                    {410.0, 420.0}}) {
      std::vector<double> weights(5, 0.0);
      add_mean_weights(set, {low, high, ""}, weights);
      double mean = 0;
      for (int i = 0; i < 5; ++i) mean += set.scale * weights[i] * kValues[i];
      EXPECT_NEAR(mean, spectrum.mean(low, high), 1e-12) << low << " " << high;
    }
  }
  std::vector<double> weights(5, 0.0);
  add_mean_weights(irregular(), {412, 413, ""}, weights);
  EXPECT_GT(weights[0], 0);
  EXPECT_GT(weights[1], 0);
  for (int i = 2; i < 5; ++i) EXPECT_EQ(weights[i], 0) << i;
}

}  // namespace
}  // namespace kiloband::test::band_set_test
