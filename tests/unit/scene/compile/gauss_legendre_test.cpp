#include "base/gauss_legendre.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kiloband::gauss_legendre_test {
namespace {

TEST(GaussLegendre, ThreeNodesAreThePublishedOnes) {
  const GaussLegendre rule = gauss_legendre(3);  // Abramowitz and Stegun, table 25.4
  ASSERT_EQ(rule.nodes.size(), 3u);
  const double nodes[] = {-0.774596669241483, 0, 0.774596669241483},
               weights[] = {0.555555555555556, 0.888888888888889, 0.555555555555556};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(rule.nodes[i], nodes[i], 1e-15);
    EXPECT_NEAR(rule.weights[i], weights[i], 1e-15);
  }
}

TEST(GaussLegendre, IntegratesPolynomialsUpToItsDegree) {
  for (const int n : {1, 2, 7, 32, 64, 100}) {
    const GaussLegendre rule = gauss_legendre(n);
    EXPECT_TRUE(std::ranges::is_sorted(rule.nodes));
    for (const int power : {0, 1, 2 * n - 2, 2 * n - 1}) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += rule.weights[i] * std::pow(rule.nodes[i], power);
      EXPECT_NEAR(sum, power % 2 ? 0.0 : 2.0 / (power + 1), 1e-14) << n << " nodes, power " << power;
    }
    double beyond = 0;  // of degree 2 n it is too small
    for (int i = 0; i < n; ++i) beyond += rule.weights[i] * std::pow(rule.nodes[i], 2 * n);
    if (n > 7) continue;
    EXPECT_LT(beyond, 2.0 / (2 * n + 1) - 1e-9);
  }
}

}  // namespace
}  // namespace kiloband::gauss_legendre_test
