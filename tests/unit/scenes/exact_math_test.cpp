// The generator's elementary functions against those of the C library,
// and values that they must have on every machine.
#include "scenes/generator/exact_math.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kiloband::test {
namespace {

using namespace generator;

TEST(ExactMath, AgreesWithTheLibrary) {
  for (int i = -20000; i <= 20000; ++i) {
    const double x = i * 0.00731;
    EXPECT_NEAR(sine(x), std::sin(x), 4e-16) << x;
    EXPECT_NEAR(cosine(x), std::cos(x), 4e-16) << x;
    EXPECT_NEAR(exponential(x) / std::exp(x), 1, 2e-15) << x;
    if (x > 0) {
      EXPECT_NEAR(logarithm(x), std::log(x), 1e-15 * (1 + std::fabs(std::log(x)))) << x;
      EXPECT_NEAR(power(x, 0.37) / std::pow(x, 0.37), 1, 4e-15) << x;
    }
    const double y = 3 * std::sin(i * 0.1);
    EXPECT_NEAR(arctangent(y, x), std::atan2(y, x), 1e-15) << y << ", " << x;
  }
}

TEST(ExactMath, HardPlaces) {
  EXPECT_EQ(sine(0), 0);
  EXPECT_EQ(cosine(0), 1);
  EXPECT_EQ(arctangent(0, 0), 0);
  EXPECT_NEAR(arctangent(0, -1), kPi, 1e-15);
  EXPECT_NEAR(arctangent(-1, 0), -kPi / 2, 1e-15);
  EXPECT_NEAR(sine(99999.5), std::sin(99999.5), 1e-11);
  EXPECT_EQ(power(0, 0.5), 0);
  EXPECT_EQ(exponential(0), 1);
  EXPECT_EQ(logarithm(1), 0);
  EXPECT_NEAR(exponential(-690) / std::exp(-690), 1, 2e-15);
}

/// Bits, not values: they were taken once and hold for every compiler and processor.
TEST(ExactMath, SameBitsEverywhere) {
  EXPECT_EQ(sine(1.1), 0x1.c84c54c2d6338p-1);
  EXPECT_EQ(cosine(2.2), -0x1.2d5004b88ad7p-1);
  EXPECT_EQ(arctangent(0.3, -0.7), 0x1.5e4c36ca0118ap+1);
  EXPECT_EQ(exponential(3.3), 0x1.b1cd5e7807b7bp+4);
  EXPECT_EQ(logarithm(0.044), -0x1.8fd0ffc23aafdp+1);
  EXPECT_EQ(random_number(5, 7), 0x1.8a567deb38c9dp-1);
}

TEST(ExactMath, RandomNumbersAreUniform) {
  double sum = 0, squares = 0;
  constexpr unsigned kCount = 100000;
  for (unsigned i = 0; i < kCount; ++i) {
    const double u = random_number(3, i);
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  // Means 1/2 and 1/3; five standard deviations (false alarm 6e-7 each).
  EXPECT_NEAR(sum / kCount, 0.5, 5 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kCount));
}

}  // namespace
}  // namespace kiloband::test
