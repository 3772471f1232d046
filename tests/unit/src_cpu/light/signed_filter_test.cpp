// Filters with negative lobes: their formulas, and what is drawn from their tables.
#include "film/signed_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kiloband::test::signed_filter_test {
namespace {

/// Integral over [from, to] by the midpoint rule, without the tables' cells.
template <class F>
double integral(const F& f, double from, double to) {
  constexpr int kSteps = 200000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += f(from + (to - from) * (i + 0.5) / kSteps);
  return sum * (to - from) / kSteps;
}

/// Mitsuba 3.9.1's values (rfilter.eval) at 0, 0.3, 0.5, 1.3, 1.5, 2.5: rounded to five digits.
TEST(SignedFilter, FormulasAreThoseOfMitsuba) {
  const double x[] = {0, 0.3, 0.5, 1.3, 1.5, 2.5};
  const double third[] = {0.88889, 0.74039, 0.53472, -0.02994, -0.03472, 0};
  const double other[] = {0.93333, 0.77673, 0.55833, -0.06207, -0.05833, 0};  // B = 0.2, C = 0.5
  const double spline[] = {1, 0.8155, 0.5625, -0.0735, -0.0625, 0};
  const double three[] = {1, 0.84434, 0.60793, -0.14233, -0.13509, 0.02432};
  const double two[] = {1, 0.82697, 0.57316, -0.08643, -0.06368, 0};
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(mitchell(x[i], 1.0 / 3, 1.0 / 3), third[i], 5e-6) << x[i];
    EXPECT_NEAR(mitchell(x[i], 0.2, 0.5), other[i], 5e-6) << x[i];
    EXPECT_NEAR(mitchell(x[i], 0, 0.5), spline[i], 5e-6) << x[i];
    EXPECT_NEAR(lanczos(x[i], 3), three[i], 5e-6) << x[i];
    EXPECT_NEAR(lanczos(x[i], 2), two[i], 5e-6) << x[i];
  }
  EXPECT_NEAR(lanczos(1e-5, 3), lanczos(2e-4, 3), 1e-7);  // the series meets the quotient
}

/// The table's share of samples beyond x, with their signs and the scale of one axis, against the filter's own.
void expect_distribution(double (*f)(double), double radius) {
  const SignedFilter filter = make_signed_filter(f, radius);
  ASSERT_EQ(filter.cells.size(), 2u * kFilterPieces + 1);
  const double whole = integral(f, 0, radius), scale = std::sqrt(filter.scale);
  EXPECT_NEAR(scale, integral([&](double x) { return std::fabs(f(x)); }, 0, radius) / whole, 3e-6);
  double signed_sum = 0;
  for (int i = 0; i < kFilterPieces; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (i % 64 == 0) {
      EXPECT_NEAR(signed_sum * scale, integral(f, 0, radius * i / kFilterPieces) / whole, 2e-6) << i;
    }
    const double p = double{filter.cells[k + 1]} - filter.cells[k];
    ASSERT_GE(p, 0);
    signed_sum += p * filter.cells[kFilterPieces + 1 + k];
  }
  EXPECT_NEAR(signed_sum * scale, 1, 2e-6);
}

TEST(SignedFilter, TablesHaveTheFiltersDistribution) {
  expect_distribution([](double x) { return mitchell(x, 1.0 / 3, 1.0 / 3); }, 2);
  expect_distribution([](double x) { return mitchell(x, 0, 0.5); }, 2);
  expect_distribution([](double x) { return mitchell(x, -2, 3); }, 2);
  expect_distribution([](double x) { return lanczos(x, 3); }, 3);
  expect_distribution([](double x) { return lanczos(x, 16); }, 16);
}

TEST(SignedFilter, APositiveOneHasNoSigns) {
  const SignedFilter spline = make_signed_filter([](double x) { return mitchell(x, 1, 0); }, 2);
  EXPECT_FALSE(spline.negative);
  EXPECT_NEAR(spline.scale, 1, 1e-12);
  EXPECT_TRUE(make_signed_filter([](double x) { return mitchell(x, 0, 0.5); }, 2).negative);
}

TEST(SignedFilter, AFilterWithoutAnIntegralIsRefused) {
  EXPECT_THROW(make_signed_filter([](double x) { return x < 1 ? 1.0 : -1.0; }, 2), std::logic_error);
  EXPECT_THROW(make_signed_filter([](double) { return 0.0; }, 2), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test::signed_filter_test
