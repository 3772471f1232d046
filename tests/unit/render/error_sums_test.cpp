// The error figure: every band for itself, pixels without error bar left out.
#include "render/error_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace kiloband::error_sums_test {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void add(ErrorSums& sums, const std::vector<double>& means, const std::vector<double>& variances) {
  sums.add(means, variances);
}

TEST(ErrorSums, WorstAndMedianOfTheBandsWithLight) {
  ErrorSums sums(5);
  // RMS error 0.2 of mean 2, 0.4 of 2; no light: no relative error; a response may be negative: 0.05; nothing
  // is known of the last.
  for (const double mean : {1.0, 3.0}) add(sums, {mean, mean, 0, -mean, 0}, {0.04, 0.16, 0, 0.01, kNone});
  const BandErrors errors = sums.errors();
  EXPECT_DOUBLE_EQ(*errors.worst, 0.2);
  EXPECT_EQ(errors.worst_band, 1u);
  EXPECT_DOUBLE_EQ(errors.median, 0.1);
  EXPECT_EQ(errors.dark_bands, 1u);
}

TEST(ErrorSums, PixelsWithoutErrorBarAreLeftOutOfTheirBandAlone) {
  ErrorSums sums(2);
  add(sums, {1000, 1}, {kNone, 0.25});
  add(sums, {1, 1}, {0.01, kNone});
  EXPECT_DOUBLE_EQ(*sums.errors().worst, 0.5);
  EXPECT_EQ(sums.errors().worst_band, 1u);
}

TEST(ErrorSums, AVarianceBeyondFloatIsNoSmallError) {
  ErrorSums sums(2);
  add(sums, {1, 1e19}, {0.01, kInfinity});
  EXPECT_EQ(*sums.errors().worst, kInfinity);
}

TEST(ErrorSums, NothingHasNoError) {
  ErrorSums sums(1);
  EXPECT_FALSE(sums.errors().worst);
  EXPECT_EQ(sums.errors().dark_bands, 0u);
  add(sums, {0}, {0});
  add(sums, {1}, {kNone});
  EXPECT_FALSE(sums.errors().worst);
  EXPECT_EQ(sums.errors().dark_bands, 1u);
}

TEST(ErrorSums, APixelHasAllBands) {
  ErrorSums sums(2);
  EXPECT_THROW(add(sums, {1}, {1}), std::logic_error);
  EXPECT_THROW(add(sums, {1, 1}, {1}), std::logic_error);
}

}  // namespace
}  // namespace kiloband::error_sums_test
