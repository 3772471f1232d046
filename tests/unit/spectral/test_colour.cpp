#include <gtest/gtest.h>

#include <cmath>

#include "spectral/colour.hpp"

namespace kiloband::test {
namespace {

TEST(Colour, MatchingFunctionsAtPublishedWavelengths) {
  EXPECT_DOUBLE_EQ(cie_y()(555), 1.0);
  EXPECT_DOUBLE_EQ(cie_y()(560), 0.995);
  EXPECT_DOUBLE_EQ(cie_x()(600), 1.0622);
  EXPECT_DOUBLE_EQ(cie_z()(450), 1.77211);
  EXPECT_DOUBLE_EQ(cie_y()(557.5), 0.9975);  // linear between 5 nm entries
  EXPECT_EQ(cie_y()(359.99), 0);
  EXPECT_EQ(cie_y()(830.01), 0);
  EXPECT_GT(cie_y()(360), 0);
  EXPECT_GT(cie_y()(830), 0);
}

// The observer's three curves enclose equal areas (CIE); the trapezoid rule is exact for the interpolated
// table.
TEST(Colour, IntegralsOfTheMatchingFunctions) {
  EXPECT_NEAR(cie_y().integral(360, 830), 106.857028, 1e-6);
  EXPECT_NEAR(cie_x().integral(360, 830) / cie_y().integral(360, 830), 1, 2e-4);
  EXPECT_NEAR(cie_z().integral(360, 830) / cie_y().integral(360, 830), 1, 5e-4);
}

// Mitsuba 3's constant is not that integral: it is the mean of 1000 samples from 360 to 830 nm times 470 nm.
TEST(Colour, MitsubasNormalisationIsAMeanOfThousandSamples) {
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += cie_y()(360 + 470.0 * i / 999);
  EXPECT_NEAR(sum / 1000 * 470 / kCieYIntegral, 1, 1e-6);
}

TEST(Colour, D65HasUnitLuminanceUnderMitsubasConstants) {
  EXPECT_DOUBLE_EQ(illuminant_d65()(560) * 98.99741751876255, 100);
  const double y = Spectrum::product(illuminant_d65(), cie_y()).integral(360, 830) / kCieYIntegral;
  EXPECT_NEAR(y, 1, 1.1e-4);
}

TEST(Colour, D65IsWhite) {
  std::array<double, 3> xyz;
  const Spectrum* matching[3] = {&cie_x(), &cie_y(), &cie_z()};
  for (int i = 0; i < 3; ++i) xyz[i] = Spectrum::product(illuminant_d65(), *matching[i]).integral(360, 830);
  const double white_y = xyz[1];
  for (double& component : xyz) component /= white_y;
  EXPECT_NEAR(xyz[0] / (xyz[0] + xyz[1] + xyz[2]), 0.3127, 5e-5);  // CIE chromaticity of D65
  EXPECT_NEAR(xyz[1] / (xyz[0] + xyz[1] + xyz[2]), 0.3290, 5e-5);
  for (const double component : xyz_to_linear_srgb(xyz)) EXPECT_NEAR(component, 1, 1e-4);
}

// The primaries of ITU-R BT.709: red (0.64, 0.33) has no green and no blue.
TEST(Colour, PrimariesOfSrgb) {
  const double primaries[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
  for (int k = 0; k < 3; ++k) {
    const auto [x, y] = primaries[k];
    const auto rgb = xyz_to_linear_srgb({x / y, 1, (1 - x - y) / y});
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(rgb[j] / rgb[k], j == k ? 1 : 0, 2e-5) << k << j;
  }
}

TEST(Colour, TransferFunctionPublishedValuesAndRoundTrip) {
  EXPECT_NEAR(srgb_encode(0.5), 0.735357, 1e-6);
  EXPECT_NEAR(srgb_decode(0.5), 0.214041, 1e-6);
  EXPECT_NEAR(srgb_encode(0.002), 0.02584, 1e-12);
  EXPECT_EQ(srgb_encode(-1), 0);
  EXPECT_NEAR(srgb_encode(7), 1, 1e-15);
  for (int i = 0; i <= 255; ++i) EXPECT_NEAR(srgb_encode(srgb_decode(i / 255.0)), i / 255.0, 1e-7);
}

}  // namespace
}  // namespace kiloband::test
