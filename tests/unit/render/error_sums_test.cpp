// The error figure: every band for itself, pixels without error bar left out.
#include "render/error_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kiloband {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(ErrorSums, LargestOverTheBands) {
  ErrorSums sums(3);
  for (const double mean : {1.0, 3.0}) {
    sums.add(0, mean, 0.04);  // RMS error 0.2 of mean 2
    sums.add(1, mean, 0.16);  // 0.4 of 2
    sums.add(2, 0, 100);      // no light: no relative error
  }
  EXPECT_DOUBLE_EQ(*sums.relative_error(), 0.2);
}

TEST(ErrorSums, PixelsWithoutErrorBarAreLeftOutOfTheirBandAlone) {
  ErrorSums sums(2);
  sums.add(0, 1000, kNone);
  sums.add(0, 1, 0.01);
  sums.add(1, 1, 0.25);
  sums.add(1, 1, kNone);
  EXPECT_DOUBLE_EQ(*sums.relative_error(), 0.5);
}

TEST(ErrorSums, AVarianceBeyondFloatIsNoSmallError) {
  ErrorSums sums(2);
  sums.add(0, 1, 0.01);
  sums.add(1, 1e19, kInfinity);
  EXPECT_EQ(*sums.relative_error(), kInfinity);
}

TEST(ErrorSums, NothingHasNoError) {
  ErrorSums sums(1);
  EXPECT_FALSE(sums.relative_error());
  sums.add(0, 0, 0);
  sums.add(0, 1, kNone);
  EXPECT_FALSE(sums.relative_error());
}

}  // namespace
}  // namespace kiloband
