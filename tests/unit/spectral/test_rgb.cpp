#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "spectral/colour/colour.hpp"
#include "spectral/colour/rgb.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

double d65_luminance() {
  static const double value = Spectrum::product(illuminant_d65(), cie_y()).integral(360, 830);
  return value;
}

/// Linear sRGB of a spectral power, Y = 1 for D65: exact integrals, independent of the solver's quadrature.
Rgb colour_of(const Spectrum& power) {
  std::array<double, 3> xyz;
  const Spectrum* matching[3] = {&cie_x(), &cie_y(), &cie_z()};
  for (int i = 0; i < 3; ++i)
    xyz[i] = Spectrum::product(power, *matching[i]).integral(360, 830) / d65_luminance();
  return xyz_to_linear_srgb(xyz);
}

double difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

double residual(const Rgb& rgb) {
  return difference(colour_of(Spectrum::product(illuminant_d65(), rgb_reflectance(rgb))), rgb);
}

TEST(Rgb, ReproducesColoursOfTheWholeCube) {
  const double levels[] = {0, 1e-3, 0.02, 0.3, 0.8, 0.99, 1};
  for (const double r : levels)
    for (const double g : levels)
      for (const double b : levels) EXPECT_LT(residual({r, g, b}), 1e-4) << r << ' ' << g << ' ' << b;
}

TEST(Rgb, ReproducesRandomColours) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 300; ++i) {
    const Rgb rgb = {uniform(generator), uniform(generator), uniform(generator)};
    EXPECT_LT(residual(rgb), 1e-4) << rgb[0] << ' ' << rgb[1] << ' ' << rgb[2];
  }
}

TEST(Rgb, GreyIsFlatAndExact) {
  for (const double grey : {1e-6, 0.02, 0.18, 0.5, 0.9, 0.999999}) {
    const auto c = solve_sigmoid({grey, grey, grey});
    EXPECT_EQ(c[0], 0);
    EXPECT_EQ(c[1], 0);
    EXPECT_NEAR(rgb_reflectance({grey, grey, grey})(500), grey, 1e-10);
  }
}

TEST(Rgb, NearGreyIsNearlyFlat) {
  const Spectrum s = rgb_reflectance({0.5, 0.5, 0.500001});
  EXPECT_NEAR(s.max_over(360, 830), 0.5, 1e-5);
  EXPECT_NEAR(s.min_over(360, 830), 0.5, 1e-5);
}

TEST(Rgb, BlackAndWhiteAreFiniteAndExactInSinglePrecision) {
  const auto black = solve_sigmoid({0, 0, 0}), white = solve_sigmoid({1, 1, 1});
  const auto evaluate = [](const std::array<double, 3>& c) {
    const float x = 555,
                v = (static_cast<float>(c[0]) * x + static_cast<float>(c[1])) * x + static_cast<float>(c[2]);
    return 0.5f + 0.5f * v / std::sqrt(1 + v * v);
  };
  EXPECT_TRUE(std::isfinite(black[2]) && std::isfinite(white[2]));
  EXPECT_EQ(evaluate(black), 0.0f);
  EXPECT_EQ(evaluate(white), 1.0f);
  EXPECT_NEAR(rgb_reflectance({0, 0, 0})(700), 0, 1e-10);
}

TEST(Rgb, ReflectanceStaysWithinBounds) {
  for (const Rgb& rgb :
       {Rgb{1, 0, 0}, Rgb{0, 1, 0}, Rgb{0, 0, 1}, Rgb{1, 1, 0}, Rgb{0, 1, 1}, Rgb{1, 0, 1}}) {
    const Spectrum s = rgb_reflectance(rgb);
    EXPECT_GE(s.min_over(100, 20000), 0);
    EXPECT_LE(s.max_over(100, 20000), 1);
    EXPECT_EQ(s(200), s(360));  // outside 360-830 nm the end value
    EXPECT_EQ(s(10000), s(830));
  }
}

TEST(Rgb, EmissionHasItsColourAtAnyBrightness) {
  for (const Rgb& rgb :
       {Rgb{1, 1, 1}, Rgb{17, 12, 4}, Rgb{0, 0, 3e-3}, Rgb{1e5, 2e4, 0}, Rgb{18.387, 13.9873, 6.75357}}) {
    // Y is relative to D65 / 98.9974, which has 98.987 / 98.9974.
    const Rgb have = colour_of(rgb_emission(rgb));
    EXPECT_LT(difference(have, rgb) / std::max({rgb[0], rgb[1], rgb[2]}), 1.5e-4);
  }
  EXPECT_TRUE(rgb_emission({0, 0, 0}).is_constant());
  EXPECT_EQ(rgb_emission({1, 1, 1})(359), 0);
  EXPECT_EQ(rgb_emission({1, 1, 1})(900), 0);
}

TEST(Rgb, ComponentsOutsideTheRuleAreRefused) {
  EXPECT_EQ(error_of([] { rgb_reflectance({0.5, 1.2, 0}); }), "rgb: green 1.2: must be in [0, 1]");
  EXPECT_EQ(error_of([] { rgb_reflectance({-0.1, 1, 0}); }), "rgb: red -0.1: must be in [0, 1]");
  EXPECT_EQ(error_of([] { rgb_reflectance({0, 0, NAN}); }), "rgb: blue nan: must be in [0, 1]");
  EXPECT_EQ(error_of([] { rgb_emission({0, 0, INFINITY}); }), "rgb: blue inf: must be finite and at least 0");
  EXPECT_EQ(error_of([] { rgb_emission({0, -1, 1}); }), "rgb: green -1: must be finite and at least 0");
  EXPECT_THROW(solve_sigmoid({0, 0, 2}), std::logic_error);
}

/// Colour of single-precision coefficients evaluated in single precision, as a texture lookup does.
Rgb colour_of(const std::array<float, 3>& c) {
  static const Spectrum weights[3] = {Spectrum::product(illuminant_d65(), cie_x()),
                                      Spectrum::product(illuminant_d65(), cie_y()),
                                      Spectrum::product(illuminant_d65(), cie_z())};
  std::array<double, 3> xyz{};
  for (int i = 0; i < 470; ++i) {
    const float y = -234.5f + static_cast<float>(i);
    const float v = (c[0] * y + c[1]) * y + c[2];
    const double s = 0.5f + 0.5f * v / std::sqrt(1 + v * v);
    for (int k = 0; k < 3; ++k) xyz[k] += s * weights[k](595 + y) / d65_luminance();
  }
  return xyz_to_linear_srgb(xyz);
}

TEST(SigmoidTable, ReproducesColours) {
  const SigmoidTable table;
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  const float edge[] = {0, 1.0f / 255, 0.5f, 1};
  for (int i = 0; i < 3000; ++i) {
    std::array<float, 3> rgb;
    // Half of them with components from the cube's faces, a quarter dark.
    for (float& component : rgb) component = i % 2 ? edge[generator() % 4] : uniform(generator);
    if (i % 4 == 0)
      for (float& component : rgb) component *= 0.01f;
    EXPECT_LT(difference(colour_of(table(rgb)), {rgb[0], rgb[1], rgb[2]}), 1e-3)
        << rgb[0] << ' ' << rgb[1] << ' ' << rgb[2];
  }
}

TEST(SigmoidTable, AgreesWithTheSolver) {
  const SigmoidTable table;
  const std::array<float, 3> rgb = {0.3f, 0.5f, 0.2f};
  const auto c = table(rgb);
  const Spectrum exact = rgb_reflectance({0.3f, 0.5f, 0.2f});
  for (double lambda_nm = 360; lambda_nm <= 830; lambda_nm += 10) {
    const double y = lambda_nm - 595, v = (c[0] * y + c[1]) * y + c[2];
    EXPECT_NEAR(0.5 + v / (2 * std::sqrt(1 + v * v)), exact(lambda_nm), 5e-3);
  }
}

TEST(SigmoidTable, GreyIsFlat) {
  const auto c = SigmoidTable()({0.25f, 0.25f, 0.25f});
  EXPECT_EQ(c[0], 0);
  EXPECT_EQ(c[1], 0);
  EXPECT_NEAR(Spectrum::sigmoid({c[0], c[1], c[2]}, 1)(500), 0.25, 1e-7);
}

}  // namespace
}  // namespace kiloband::test
