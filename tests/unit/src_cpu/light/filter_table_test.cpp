// The table of the truncated Gaussian filter against its exact inverse and its distribution.
#include "film/filter_table.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace kiloband::test::filter_table_test {
namespace {

/// Tail probability of a distance x, by the midpoint rule: the definition, without the closed form.
double tail_probability(double x, double ratio) {
  constexpr int kSteps = 20000;
  const auto integral = [&](double from) {
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double y = from + (ratio - from) * (i + 0.5) / kSteps;
      sum += std::exp(-0.5 * y * y) - std::exp(-0.5 * ratio * ratio);
    }
    return sum * (ratio - from) / kSteps;
  };
  return integral(x) / integral(0);
}

TEST(FilterTable, NodesInvertTheDistribution) {
  for (const double ratio : {0.5, 2.0, 4.0, 6.0}) {
    const std::vector<KbFloat2> table = make_gaussian_filter_table(ratio);
    ASSERT_EQ(table.size(), kFilterPieces + 1u);
    EXPECT_EQ(table.front().x, static_cast<float>(ratio));
    EXPECT_NEAR(table.back().x, 0, 1e-12);
    for (const int i : {100, 300, 512, 900, 1000}) {
      const double q = static_cast<double>(i) / kFilterPieces;
      EXPECT_NEAR(tail_probability(table[i].x, ratio), q * q, 1e-6) << ratio << " " << i;
    }
  }
}

TEST(FilterTable, BetweenTheNodes) {
  for (const double ratio : {0.1, 0.7, 2.0, 4.0}) {
    const std::vector<KbFloat2> table = make_gaussian_filter_table(ratio);
    for (int i = 0; i <= 5000; ++i) {
      const auto w = static_cast<float>(i / 5000.0 * (i / 5000.0));
      EXPECT_NEAR(gaussian_distance(table, w), invert_gaussian_tail(w, ratio), 1.1e-7 * ratio)
          << ratio << " " << w;
    }
  }
}

/// Whatever the ratio: finite, inside the support, falling with w.
TEST(FilterTable, AnyRatio) {
  for (const double ratio : {1e-6, 1e-3, 5.0, 8.0, 20.0, 30.0, 1e3, 1e30}) {
    const std::vector<KbFloat2> table = make_gaussian_filter_table(ratio);
    double last = ratio;
    for (int i = 0; i <= 100000; ++i) {
      const double q = i / 100000.0;
      const double x = gaussian_distance(table, static_cast<float>(q * q));
      ASSERT_TRUE(x >= -1e-6 * ratio && x <= last + 1e-6 * std::min(ratio, 30.0))
          << ratio << " " << q << " " << x;
      last = x;
    }
  }
  // A parabola: half of a side's samples lie within 0.3473 of its width (w = 1 - 1.5 x + 0.5 x^3).
  EXPECT_NEAR(gaussian_distance(make_gaussian_filter_table(1e-4), 0.5f), 0.34730e-4, 1e-9);
  EXPECT_THROW(make_gaussian_filter_table(0), std::logic_error);
  EXPECT_THROW(make_gaussian_filter_table(std::nan("")), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test::filter_table_test
