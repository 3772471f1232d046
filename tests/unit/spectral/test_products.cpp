// Products of spectra whose data end, are continued, or have no range: values, means, bounds and tables agree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "spectral/spectrum.hpp"

namespace kiloband::test::products_test {
namespace {

double uniform(std::mt19937& random, double min, double max) {
  return std::uniform_real_distribution<double>(min, max)(random);
}

/// A spectrum with the wavelengths where it has kinks and jumps.
struct Factor {
  Spectrum spectrum;
  std::vector<double> kinks_nm;
};

Factor random_table(std::mt19937& random) {
  std::vector<double> lambda_nm, values;
  const int points = 1 + static_cast<int>(random() % 6);
  double x = uniform(random, 320, 800);
  for (int i = 0; i < points; ++i, x += uniform(random, 5, 120)) {
    lambda_nm.push_back(x);
    values.push_back(uniform(random, -0.5, 2));
  }
  return {Spectrum::tabulated(lambda_nm, values, random() % 2 > 0), lambda_nm};
}

Factor random_factor(std::mt19937& random) {
  switch (random() % 8) {
    case 0:
      return {Spectrum::sigmoid({uniform(random, -1e-5, 1e-5), 0, uniform(random, -2, 2)}, 1), {360, 830}};
    case 1:
      return {Spectrum::planck(uniform(random, 2500, 6000), 1e-4), {}};
    case 2:
      return {Spectrum::planck(uniform(random, 2500, 6000), 1e-4, Spectrum::Range{420, 760}), {420, 760}};
    case 3:
      return {Spectrum::constant(uniform(random, 0.5, 2)), {}};
    default:
      return random_table(random);
  }
}

/// Midpoint rule between kinks and jumps: its error is 1e-6 of the integral of the magnitude.
double reference_integral(const Spectrum& s, const std::vector<double>& kinks_nm, double min_nm,
                          double max_nm) {
  std::vector<double> ends_nm = {min_nm, max_nm};
  for (const double kink_nm : kinks_nm)
    if (kink_nm > min_nm && kink_nm < max_nm) ends_nm.push_back(kink_nm);
  std::sort(ends_nm.begin(), ends_nm.end());
  double sum = 0;
  constexpr int kParts = 500;
  for (std::size_t i = 0; i + 1 < ends_nm.size(); ++i) {
    const double step_nm = (ends_nm[i + 1] - ends_nm[i]) / kParts;
    for (int j = 0; j < kParts; ++j) sum += step_nm * s(ends_nm[i] + (j + 0.5) * step_nm);
  }
  return sum;
}

/// Bounds and table of the product on [min_nm, max_nm] against its values.
void expect_agreement(const Spectrum& product, const std::vector<double>& kinks_nm, double min_nm,
                      double max_nm, std::mt19937& random) {
  const double highest = product.max_over(min_nm, max_nm), lowest = product.min_over(min_nm, max_nm);
  const double magnitude = std::max(std::abs(highest), std::abs(lowest));
  EXPECT_NEAR(product.mean(min_nm, max_nm),
              reference_integral(product, kinks_nm, min_nm, max_nm) / (max_nm - min_nm), 3e-6 * magnitude);
  const RegularTable table = resample(product, min_nm, max_nm, {1e-3, 1u << 20});
  EXPECT_LE(table.max_error, 1e-3 * magnitude);
  double seen_high = -INFINITY, seen_low = INFINITY;
  for (int i = 0; i < 2000; ++i) {
    const double lambda_nm = uniform(random, min_nm, max_nm), value = product(lambda_nm);
    seen_high = std::max(seen_high, value);
    seen_low = std::min(seen_low, value);
    ASSERT_NEAR(table(lambda_nm), value, table.max_error + 1e-12 * magnitude) << lambda_nm;
  }
  EXPECT_GE(highest, seen_high);
  EXPECT_LE(lowest, seen_low);
}

TEST(Products, ValuesMeansBoundsAndTablesAgree) {
  std::mt19937 random(11);
  for (int i = 0; i < 600; ++i) {
    SCOPED_TRACE(i);
    Factor product = random_factor(random);
    std::vector<Spectrum> factors = {product.spectrum};
    for (int left = 1 + static_cast<int>(random() % 3); left > 0; --left) {
      const Factor factor = random_factor(random);
      product.spectrum = Spectrum::product(product.spectrum, factor.spectrum);
      product.kinks_nm.insert(product.kinks_nm.end(), factor.kinks_nm.begin(), factor.kinks_nm.end());
      factors.push_back(factor.spectrum);
    }
    for (int j = 0; j < 50; ++j) {
      const double lambda_nm = uniform(random, 250, 1300);
      double value = 1;
      for (const Spectrum& factor : factors) value *= factor(lambda_nm);
      ASSERT_NEAR(product.spectrum(lambda_nm), value, 1e-12 * std::abs(value)) << lambda_nm;
    }
    const double min_nm = uniform(random, 250, 900);
    expect_agreement(product.spectrum, product.kinks_nm, min_nm, min_nm + uniform(random, 20, 700), random);
    if (::testing::Test::HasFailure()) return;
  }
}

// A factor that is continued does not end a product; one that is not does.
TEST(Products, DataThatAreContinuedDoNotEndAProduct) {
  const Spectrum continued = Spectrum::tabulated({500, 600}, {1, 2}, true);
  const Spectrum ending = Spectrum::tabulated({400, 450, 700}, {1, 3, 1});
  const Spectrum product = Spectrum::product(continued, ending);
  EXPECT_FALSE(product.extrapolates());
  EXPECT_EQ(product.data_range()->min_nm, 400);
  EXPECT_EQ(product.data_range()->max_nm, 700);
  const RegularTable table = resample(product, 380, 780);
  EXPECT_NEAR(table(480), 2.76, 3e-4);
  EXPECT_NEAR(table(640), 2.96, 3e-4);
  EXPECT_EQ(table(399.9), 0);
  EXPECT_EQ(table(700.1), 0);
  EXPECT_FALSE(Spectrum::product(Spectrum::planck(3000, 1), Spectrum::planck(4000, 1)).extrapolates());
}

// Flat light of a colour is the same light, however it says that it is flat.
TEST(Products, FlatDataAreAConstantWhereTheyAreGiven) {
  const Spectrum colour = Spectrum::sigmoid({1e-5, -0.01, 1}, 1);
  const Spectrum flat = Spectrum::tabulated({300, 2500}, {1, 1});
  const RegularTable a = resample(Spectrum::product(flat, colour), 350, 2400),
                     b = resample(colour, 350, 2400);
  for (double lambda_nm = 351; lambda_nm < 2400; lambda_nm += 0.7)
    ASSERT_NEAR(a(lambda_nm), b(lambda_nm), 2e-4) << lambda_nm;
  EXPECT_EQ(a(1500), colour(830));
}

// Where all factors are continued, the product varies from the first to the last of all data, gaps included.
TEST(Products, ContinuedFactorsVaryOverAllTheirData) {
  const Spectrum product = Spectrum::product(Spectrum::tabulated({400, 500}, {1, 2}, true),
                                             Spectrum::tabulated({600, 700}, {3, 5}, true));
  EXPECT_TRUE(product.extrapolates());
  const RegularTable table = resample(product, 300, 14000);
  EXPECT_TRUE(table.extrapolate);
  EXPECT_EQ(table.min_nm, 400);
  EXPECT_LE(table.values.size(), 4097u);
  for (const double lambda_nm : {350.0, 450.0, 550.0, 650.0, 701.0, 13000.0})
    EXPECT_NEAR(table(lambda_nm), product(lambda_nm), 1e-3) << lambda_nm;
  EXPECT_EQ(resample(product, 720, 900)(800), 10);
}

}  // namespace
}  // namespace kiloband::test::products_test
