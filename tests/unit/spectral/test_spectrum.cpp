#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "spectral/planck.hpp"
#include "spectral/spectrum.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

/// Midpoint rule on many points: slow, plain, independent of the library's quadrature.
double brute_integral(const Spectrum& s, double min_nm, double max_nm, int parts = 200000) {
  double sum = 0;
  for (int i = 0; i < parts; ++i) sum += s(min_nm + (max_nm - min_nm) * (i + 0.5) / parts);
  return sum * (max_nm - min_nm) / parts;
}

/// Checks max_over and min_over against dense samples and the kinks: bounds,
/// and not wider than 1e-3 of the value.
void expect_tight_bounds(const Spectrum& s, double min_nm, double max_nm,
                         const std::vector<double>& kinks_nm = {}) {
  double highest = -INFINITY, lowest = INFINITY;
  const auto look = [&](double lambda_nm) {
    if (lambda_nm < min_nm || lambda_nm > max_nm) return;
    highest = std::max(highest, s(lambda_nm));
    lowest = std::min(lowest, s(lambda_nm));
  };
  for (int i = 0; i <= 50000; ++i) look(min_nm + (max_nm - min_nm) * i / 50000);
  for (const double kink_nm : kinks_nm) look(kink_nm);
  const double upper = s.max_over(min_nm, max_nm), lower = s.min_over(min_nm, max_nm);
  EXPECT_GE(upper, highest);
  EXPECT_LE(lower, lowest);
  EXPECT_LE(upper, highest + 1.1e-3 * std::abs(highest) + 1e-9);
  EXPECT_GE(lower, lowest - 1.1e-3 * std::abs(lowest) - 1e-9);
}

Spectrum triangle() {
  return Spectrum::tabulated({400, 500, 700}, {0, 2, 1});
}

TEST(Spectrum, DefaultIsZero) {
  const Spectrum s;
  EXPECT_EQ(s(500), 0);
  EXPECT_TRUE(s.is_constant());
  EXPECT_FALSE(s.data_range().has_value());
}

TEST(Spectrum, ConstantEverywhere) {
  const Spectrum s = Spectrum::constant(0.3);
  EXPECT_EQ(s(1), 0.3);
  EXPECT_DOUBLE_EQ(s.integral(400, 410), 3);
  EXPECT_EQ(s.max_over(1, 1e6), 0.3);
  EXPECT_DOUBLE_EQ(s.mean(100, 700), 0.3);
}

TEST(Spectrum, TableIsLinearBetweenAndZeroOutside) {
  const Spectrum s = triangle();
  EXPECT_EQ(s(400), 0);
  EXPECT_EQ(s(500), 2);
  EXPECT_EQ(s(700), 1);
  EXPECT_DOUBLE_EQ(s(450), 1);
  EXPECT_DOUBLE_EQ(s(600), 1.5);
  EXPECT_EQ(s(700.0001), 0);
  EXPECT_EQ(s(399), 0);
  EXPECT_EQ(s(std::nan("")), 0);
  EXPECT_FALSE(s.extrapolates());
  EXPECT_EQ(s.data_range()->min_nm, 400);
}

TEST(Spectrum, ExtrapolatedKeepsEndValues) {
  const Spectrum s = triangle().extrapolated();
  EXPECT_TRUE(s.extrapolates());
  EXPECT_EQ(s(1e5), 1);
  EXPECT_EQ(s(100), 0);
  EXPECT_DOUBLE_EQ(s.integral(700, 800), 100);
  EXPECT_DOUBLE_EQ(s.integral(800, 900), 100);
  EXPECT_DOUBLE_EQ(s.integral(600, 800), 125 + 100);
  EXPECT_EQ(s.knots_nm().size(), 3u);
}

TEST(Spectrum, TableIntegralsAreExact) {
  const Spectrum s = triangle();
  EXPECT_DOUBLE_EQ(s.integral(400, 700), 100 + 300);
  EXPECT_DOUBLE_EQ(s.integral(0, 5000), 400);
  EXPECT_DOUBLE_EQ(s.integral(450, 550), 75 + 93.75);
  EXPECT_NEAR(s.integral(610, 610.1), 0.1 * (s(610) + s(610.1)) / 2, 1e-12);
  EXPECT_EQ(s.integral(800, 900), 0);
  EXPECT_EQ(s.integral(500, 500), 0);
}

TEST(Spectrum, TableBoundsSeeKnotsEndsAndOutside) {
  const Spectrum s = Spectrum::tabulated({400, 500, 700}, {0.5, 2, 1});
  EXPECT_EQ(s.max_over(450, 600), 2);
  EXPECT_DOUBLE_EQ(s.max_over(550, 600), 1.75);
  EXPECT_DOUBLE_EQ(s.min_over(550, 600), 1.5);
  EXPECT_EQ(s.min_over(400, 700), 0.5);
  EXPECT_EQ(s.min_over(399, 700), 0);
  EXPECT_EQ(s.max_over(800, 900), 0);
  EXPECT_EQ(s.max_over(390, 1000), 2);
}

TEST(Spectrum, SinglePoint) {
  const Spectrum point = Spectrum::tabulated({500}, {3});
  EXPECT_EQ(point(500), 3);
  EXPECT_EQ(point(501), 0);
  EXPECT_EQ(point.integral(400, 600), 0);
  EXPECT_EQ(point.extrapolated()(900), 3);
  EXPECT_DOUBLE_EQ(point.extrapolated().integral(400, 600), 600);
  double out[2];
  const double at[2] = {500, 600};
  point.evaluate(at, out);
  EXPECT_EQ(out[0], 3);
  EXPECT_EQ(out[1], 0);
}

TEST(Spectrum, EvaluateEqualsSingleCallsInAnyOrder) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(380, 720);
  std::vector<double> knots, values;
  for (double x = 400; x < 700; x += 0.1 + 3 * std::generate_canonical<double, 53>(generator)) {
    knots.push_back(x);
    values.push_back(std::sin(x));
  }
  const Spectrum table = Spectrum::tabulated(knots, values);
  std::vector<double> lambda_nm(3000), out(3000);
  for (double& lambda : lambda_nm) lambda = uniform(generator);
  for (std::size_t i = 0; i < 100; ++i) lambda_nm[i] = knots[i];
  std::sort(lambda_nm.begin() + 1500, lambda_nm.end());
  const Spectrum spectra[] = {table, Spectrum::product(table, Spectrum::sigmoid({1e-4, -0.1, 20}, 2)),
                              Spectrum::planck(3000, 1)};
  for (const Spectrum& s : spectra) {
    s.evaluate(lambda_nm, out);
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_DOUBLE_EQ(out[i], s(lambda_nm[i]));
  }
}

TEST(Spectrum, SigmoidFormulaAndItsClamp) {
  const Spectrum s = Spectrum::sigmoid({0, 0.01, -5}, 3);
  EXPECT_DOUBLE_EQ(s(500), 1.5);
  EXPECT_DOUBLE_EQ(s(600), 3 * (0.5 + 0.5 / std::sqrt(2)));
  EXPECT_EQ(s(5000), s(830));
  EXPECT_EQ(s(10), s(360));
  EXPECT_EQ(s.data_range()->max_nm, 830);
  EXPECT_TRUE(s.extrapolates());
}

TEST(Spectrum, SigmoidIntegralsMatchBruteForce) {
  // Smooth, a steep edge, a narrow peak, a narrow dip.
  const std::array<double, 3> cases[] = {
      {1e-4, -0.1, 20}, {0, 5, -3000}, {-4, 4400, -1210000 + 2}, {4, -4400, 1210000 - 2}};
  for (const auto& c : cases) {
    const Spectrum s = Spectrum::sigmoid(c, 2);
    for (const auto& [a, b] : {std::pair{360.0, 830.0}, {300.0, 1000.0}, {545.0, 552.0}})
      EXPECT_NEAR(s.integral(a, b) / brute_integral(s, a, b), 1, 1e-8) << c[0] << ' ' << a;
    expect_tight_bounds(s, 360, 830);
    expect_tight_bounds(s, 560, 600);
  }
}

TEST(Spectrum, PlanckHasItsRangeAndIntegral) {
  const Spectrum s = Spectrum::planck(3000, 2, Spectrum::Range{400, 700});
  EXPECT_DOUBLE_EQ(s(555), 2 * planck_radiance(555, 3000));
  EXPECT_EQ(s(399), 0);
  EXPECT_EQ(s(701), 0);
  EXPECT_DOUBLE_EQ(s.integral(300, 1000), 2 * planck_integral(400, 700, 3000));
  EXPECT_EQ(s.integral(800, 900), 0);
  EXPECT_EQ(s.min_over(390, 500), 0);
  expect_tight_bounds(Spectrum::planck(300, 1), 3000, 30000);
  expect_tight_bounds(Spectrum::planck(300, -1), 3000, 30000);
  EXPECT_EQ(Spectrum::planck(0, 1).integral(300, 1000), 0);
  EXPECT_EQ(Spectrum::planck(0, 1).max_over(300, 1000), 0);
  EXPECT_FALSE(Spectrum::planck(300, 1).data_range().has_value());
}

TEST(Spectrum, PlanckParametersOfPlanckOnly) {
  const auto parameters = Spectrum::planck(300, 2, Spectrum::Range{400, 700}).scaled(3).planck_parameters();
  ASSERT_TRUE(parameters.has_value());
  EXPECT_EQ(parameters->temperature_k, 300);
  EXPECT_EQ(parameters->scale, 6);
  EXPECT_EQ(parameters->range->max_nm, 700);
  EXPECT_FALSE(triangle().planck_parameters().has_value());
  EXPECT_FALSE(Spectrum::product(triangle(), Spectrum::planck(300, 1)).planck_parameters().has_value());
}

TEST(Spectrum, ProductWithConstantKeepsTheKind) {
  const Spectrum s = Spectrum::product(Spectrum::constant(2), triangle());
  EXPECT_EQ(s(500), 4);
  EXPECT_EQ(s.knot_values()[1], 4);
  EXPECT_EQ(Spectrum::product(Spectrum::constant(2), Spectrum::constant(3))(1), 6);
}

// (1 - t)(t) over [0, 100]: integral 100 / 6.
TEST(Spectrum, ProductOfTablesIsQuadratic) {
  const Spectrum p =
      Spectrum::product(Spectrum::tabulated({500, 600}, {1, 0}), Spectrum::tabulated({500, 600}, {0, 1}));
  EXPECT_NEAR(p.integral(400, 700), 100.0 / 6, 1e-10);
  EXPECT_NEAR(p.max_over(400, 700), 0.25, 2.6e-4);
  EXPECT_GE(p.max_over(400, 700), 0.25);
  EXPECT_EQ(p.min_over(400, 700), 0);
  EXPECT_TRUE(p.knots_nm().empty());
}

TEST(Spectrum, ProductsMatchBruteForce) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-1, 2);
  std::vector<double> knots, values;
  for (int i = 0; i <= 60; ++i) {
    knots.push_back(395.3 + 5.1 * i);
    values.push_back(uniform(generator));
  }
  const Spectrum table = Spectrum::tabulated(knots, values);
  const Spectrum sigmoid = Spectrum::sigmoid({-0.002, 2.2, -604}, 1);
  const Spectrum products[] = {Spectrum::product(table, sigmoid),
                               Spectrum::product(sigmoid, Spectrum::planck(2500, 1e-3)),
                               Spectrum::product(Spectrum::product(table, sigmoid), triangle()).scaled(-3)};
  for (const Spectrum& p : products) {
    const double scale = std::max(std::abs(p.max_over(380, 760)), std::abs(p.min_over(380, 760))) * 380;
    EXPECT_NEAR(p.integral(380, 760), brute_integral(p, 380, 760, 1000000), 1e-6 * scale);
    expect_tight_bounds(p, 380, 760, knots);
    expect_tight_bounds(p, 520, 525, knots);
  }
}

TEST(Spectrum, ProductRangeIsTheIntersection) {
  const Spectrum a = Spectrum::tabulated({400, 600}, {1, 1}), b = Spectrum::tabulated({500, 700}, {1, 1});
  const Spectrum p = Spectrum::product(a, b);
  EXPECT_EQ(p.data_range()->min_nm, 500);
  EXPECT_EQ(p.data_range()->max_nm, 600);
  EXPECT_FALSE(p.extrapolates());
  EXPECT_NEAR(p.integral(0, 1000), 100, 1e-9);
  EXPECT_TRUE(p.extrapolated().extrapolates());
  EXPECT_NEAR(p.extrapolated().integral(0, 1000), 1000, 1e-9);
  EXPECT_EQ(Spectrum::product(Spectrum::tabulated({400, 450}, {1, 1}), b).integral(0, 1000), 0);
}

TEST(Spectrum, ScalingKeepsEveryKind) {
  for (const Spectrum& s :
       {Spectrum::constant(2), triangle(), Spectrum::sigmoid({1e-4, -0.1, 20}, 1), Spectrum::planck(3000, 1),
        Spectrum::product(triangle(), Spectrum::planck(3000, 1))})
    EXPECT_DOUBLE_EQ(s.scaled(-1.5)(520), -1.5 * s(520));
}

TEST(Spectrum, WrongDataHaveTheirMessages) {
  const std::pair<std::function<void()>, const char*> cases[] = {
      {[] { Spectrum::tabulated({}, {}); }, "spectrum without data"},
      {[] {
         Spectrum::tabulated({400, 500}, {1});
       },
       "spectrum: 2 wavelengths but 1 values"},
      {[] {
         Spectrum::tabulated({400, 400}, {1, 2});
       },
       "spectrum: wavelength 400 nm after 400 nm: must increase strictly"},
      {[] {
         Spectrum::tabulated({500, 400.5}, {1, 2});
       },
       "spectrum: wavelength 400.5 nm after 500 nm: must increase strictly"},
      {[] {
         Spectrum::tabulated({400, NAN}, {1, 2});
       },
       "spectrum: wavelength nan: must be finite"},
      {[] {
         Spectrum::tabulated({400, 500}, {1, INFINITY});
       },
       "spectrum: value inf at 500 nm: must be finite"},
      {[] { Spectrum::constant(NAN); }, "spectrum: value nan: must be finite"},
      {[] { triangle().scaled(INFINITY); }, "spectrum: scale inf: must be finite"},
      {[] { triangle().scaled(1e308); }, "spectrum: scaled value inf: must be finite"},
      {[] {
         Spectrum::sigmoid({0, NAN, 0}, 1);
       },
       "sigmoid: coefficient nan: must be finite"},
      {[] { Spectrum::planck(-1, 1); }, "planck: temperature -1 K: must be finite and at least 0"},
      {[] { Spectrum::planck(300, NAN); }, "planck: scale nan: must be finite"},
      {[] {
         Spectrum::planck(300, 1, Spectrum::Range{500, 400});
       },
       "planck: range 500 to 400 nm: must increase"},
  };
  for (const auto& [action, message] : cases) EXPECT_EQ(error_of(action), message);
}

TEST(Spectrum, WrongIntervalsAreOurBug) {
  EXPECT_THROW(triangle().integral(500, 400), std::logic_error);
  EXPECT_THROW(triangle().max_over(NAN, 400), std::logic_error);
  std::vector<double> lambda_nm(2), out(3);
  EXPECT_THROW(triangle().evaluate(lambda_nm, out), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test
