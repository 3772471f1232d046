#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "spectral/colour/colour.hpp"

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

// The observer's three curves enclose equal areas (CIE);
// the trapezoid rule is exact for the interpolated table.
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

/// XYZ of a light on a reflectance by a direct sum over 1 nm, relative to the light's own Y.
std::array<double, 3> direct_xyz(const std::function<double(double)>& light,
                                 const std::function<double(double)>& reflectance) {
  std::array<double, 3> xyz{};
  double white = 0;
  for (double nm = 360; nm <= 830; nm += 1) {
    const double matching[3] = {cie_x()(nm), cie_y()(nm), cie_z()(nm)};
    for (int i = 0; i < 3; ++i) xyz[i] += light(nm) * reflectance(nm) * matching[i];
    white += light(nm) * matching[1];
  }
  for (double& component : xyz) component /= white;
  return xyz;
}

// Illuminant A is Planck's law with c2 = 1.435e-2 m K at 2848 K, which is 2855.5 K with today's c2 (CIE 15):
// published chromaticity (0.44757, 0.40745).
TEST(Colour, IlluminantA) {
  const Spectrum light = Spectrum::planck(2848 * 1.4387769 / 1.435, 1);
  const auto xyz = direct_xyz(light, [](double) { return 1.0; });
  EXPECT_NEAR(xyz[0] / (xyz[0] + xyz[1] + xyz[2]), 0.44757, 1e-4);
  EXPECT_NEAR(xyz[1] / (xyz[0] + xyz[1] + xyz[2]), 0.40745, 1e-4);
}

// Smooth reflectances like those of colour charts under D65: integrals of products of spectra, which previews
// and responses are made of, against a direct sum over 1 nm.
TEST(Colour, ReflectancesUnderD65AgreeWithADirectSum) {
  const auto bump = [](double nm, double centre, double width) {
    return std::exp(-0.5 * std::pow((nm - centre) / width, 2));
  };
  const std::function<double(double)> patches[] = {
      [](double) { return 0.18; },
      [&](double nm) { return 0.05 + 0.55 / (1 + std::exp((590 - nm) / 12)); },            // red
      [&](double nm) { return 0.04 + 0.4 * bump(nm, 530, 30); },                           // green
      [&](double nm) { return 0.05 + 0.35 * bump(nm, 450, 25); },                          // blue
      [&](double nm) { return 0.05 + 0.7 / (1 + std::exp((510 - nm) / 10)); },             // yellow
      [&](double nm) { return 0.1 + 0.4 * bump(nm, 430, 40) + 0.5 * bump(nm, 680, 50); },  // magenta
      [&](double nm) { return 0.12 + 0.3 * (nm - 400) / 300 * (nm > 400 && nm < 700); }};  // skin
  for (const auto& patch : patches) {
    std::vector<double> nm, values;
    for (double x = 360; x <= 830; x += 10)
      nm.push_back(x), values.push_back(patch(x));  // as charts are measured
    const Spectrum reflectance = Spectrum::tabulated(nm, values);
    const Spectrum light = Spectrum::product(illuminant_d65(), reflectance);
    const Spectrum* matching[3] = {&cie_x(), &cie_y(), &cie_z()};
    const double white = Spectrum::product(illuminant_d65(), cie_y()).integral(360, 830);
    std::array<double, 3> xyz;
    for (int i = 0; i < 3; ++i) xyz[i] = Spectrum::product(light, *matching[i]).integral(360, 830) / white;
    const auto rgb = xyz_to_linear_srgb(xyz);
    const auto expected = xyz_to_linear_srgb(direct_xyz(illuminant_d65(), reflectance));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(rgb[i], expected[i], 1e-3) << i;
  }
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

TEST(Colour, TransferFunctionPublishedValues) {
  EXPECT_NEAR(srgb_encode(0.5), 0.735357, 1e-6);
  EXPECT_NEAR(srgb_encode(0.214041), 0.5, 1e-6);
  EXPECT_NEAR(srgb_encode(0.002), 0.02584, 1e-12);
  EXPECT_EQ(srgb_encode(-1), 0);
  EXPECT_NEAR(srgb_encode(7), 1, 1e-15);
}

// IEC 61966-2-1 by hand: the linear piece, the power piece, the ends.
TEST(Colour, DecodedFromTransferFunction) {
  EXPECT_EQ(srgb_decode(0), 0);
  EXPECT_EQ(srgb_decode(1), 1);
  EXPECT_DOUBLE_EQ(srgb_decode(0.04), 0.04 / 12.92);
  EXPECT_NEAR(srgb_decode(0.5), 0.21404114, 1e-7);
  EXPECT_NEAR(srgb_decode(188.0 / 255.0), 0.50288646, 1e-7);
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(srgb_encode(srgb_decode(i / 255.0)), i / 255.0, 2e-7) << i;
}

}  // namespace
}  // namespace kiloband::test
