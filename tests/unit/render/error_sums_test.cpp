// The error figure: every band for itself, pixels without error bar left out.
#include "render/error_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kiloband {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(ErrorSums, WorstAndMedianOfTheBandsWithLight) {
  ErrorSums sums(5);
  for (const double mean : {1.0, 3.0}) {
    sums.add(0, mean, 0.04);  // RMS error 0.2 of mean 2
    sums.add(1, mean, 0.16);  // 0.4 of 2
    sums.add(2, 0, 0);        // no light: no relative error
    sums.add(3, -mean, 0.01);  // a response may be negative: 0.05
    sums.add(4, 0, kNone);     // nothing is known of it
  }
  const BandErrors errors = sums.errors();
  EXPECT_DOUBLE_EQ(*errors.worst, 0.2);
  EXPECT_EQ(errors.worst_band, 1u);
  EXPECT_DOUBLE_EQ(errors.median, 0.1);
  EXPECT_EQ(errors.dark_bands, 1u);
}

TEST(ErrorSums, PixelsWithoutErrorBarAreLeftOutOfTheirBandAlone) {
  ErrorSums sums(2);
  sums.add(0, 1000, kNone);
  sums.add(0, 1, 0.01);
  sums.add(1, 1, 0.25);
  sums.add(1, 1, kNone);
  EXPECT_DOUBLE_EQ(*sums.errors().worst, 0.5);
  EXPECT_EQ(sums.errors().worst_band, 1u);
}

TEST(ErrorSums, AVarianceBeyondFloatIsNoSmallError) {
  ErrorSums sums(2);
  sums.add(0, 1, 0.01);
  sums.add(1, 1e19, kInfinity);
  EXPECT_EQ(*sums.errors().worst, kInfinity);
}

TEST(ErrorSums, NothingHasNoError) {
  ErrorSums sums(1);
  EXPECT_FALSE(sums.errors().worst);
  EXPECT_EQ(sums.errors().dark_bands, 0u);
  sums.add(0, 0, 0);
  sums.add(0, 1, kNone);
  EXPECT_FALSE(sums.errors().worst);
  EXPECT_EQ(sums.errors().dark_bands, 1u);
}

}  // namespace
}  // namespace kiloband
