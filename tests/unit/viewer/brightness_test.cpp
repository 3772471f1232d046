#include "viewer/display/brightness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "spectral/planck.hpp"

namespace kiloband::test {
namespace {

using viewer::BrightnessTemperature;

/// Between the nodes of its table too: 997 temperatures that are none of them.
void expect_inverse(const Channel& channel, double least_k) {
  const BrightnessTemperature temperature(channel);
  for (int i = 0; i < 997; ++i) {
    const double t = least_k * std::pow(19000 / least_k, i / 996.0);
    EXPECT_NEAR(temperature(planck_integral(channel.min_nm, channel.max_nm, t)), t, 1e-4 * t)
        << channel.min_nm << "-" << channel.max_nm;
  }
}

TEST(BrightnessTemperature, InvertsPlancksLawOverTheChannel) {
  expect_inverse({8000, 12000, ""}, 21);
  expect_inverse({10000, 10001, ""}, 21);
  expect_inverse({3000, 5000, ""}, 21);
  expect_inverse({400, 410, ""}, 100);  // below it is too small for a double
}

TEST(BrightnessTemperature, HasEnds) {
  const BrightnessTemperature temperature({8000, 12000, ""});
  EXPECT_EQ(temperature(0), 0);
  EXPECT_EQ(temperature(-1), 0);
  EXPECT_EQ(temperature(1e300), BrightnessTemperature::kMostK);
  EXPECT_EQ(temperature(planck_integral(8000, 12000, 10)), BrightnessTemperature::kLeastK);
  EXPECT_TRUE(std::isnan(temperature(NAN)));
}

}  // namespace
}  // namespace kiloband::test
