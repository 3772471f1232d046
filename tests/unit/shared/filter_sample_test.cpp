// erf^-1 against Boost, filter sampling against the filters.
#include "shared/filter_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>

namespace {

// The bound that the header states. All multiples of 2^-24 near the ends, a grid between.
TEST(FilterSample, ErfInvIsWithinItsBound) {
  double worst = 0;
  const auto check = [&](float x) {
    const double exact = boost::math::erf_inv(static_cast<double>(x));
    worst = std::max(worst, std::fabs(kb_erf_inv(x) - exact) / std::fabs(exact));
  };
  for (int i = 1; i < 20'000; ++i) {
    check(1 - static_cast<float>(i) * 0x1p-24f);
    check(-1 + static_cast<float>(i) * 0x1p-24f);
    check(static_cast<float>(i) / 20'000);
    check(-static_cast<float>(i) / 20'000);
  }
  EXPECT_LT(worst, 3e-7);
  EXPECT_EQ(kb_erf_inv(0.0f), 0.0f);
  EXPECT_EQ(kb_erf_inv(1.0f), kb_erf_inv(KB_ONE_MINUS_EPSILON));
  EXPECT_EQ(kb_erf_inv(-1.0f), -kb_erf_inv(1.0f));
}

TEST(FilterSample, BoxCoversItsWidth) {
  EXPECT_EQ(kb_filter_box(0.0f, 0.5f), -0.5f);
  EXPECT_EQ(kb_filter_box(0.5f, 0.5f), 0.0f);
  EXPECT_LT(kb_filter_box(KB_ONE_MINUS_EPSILON, 0.5f), 0.5f);
}

// F(x) = (1 + x/r)^2 / 2 below 0, 1 - (1 - x/r)^2 / 2 above.
TEST(FilterSample, TentInvertsItsDistribution) {
  for (const float radius : {1.0f, 1.5f})
    for (int i = 0; i < 4096; ++i) {
      const float u = static_cast<float>(i) / 4096;
      const double t = kb_filter_tent(u, radius) / radius;
      EXPECT_NEAR(t < 0 ? (1 + t) * (1 + t) / 2 : 1 - (1 - t) * (1 - t) / 2, u, 2e-7);
    }
}

// F(x) = (1 + erf(x / (s sqrt 2)) / erf(r / (s sqrt 2))) / 2.
TEST(FilterSample, GaussianInvertsItsDistribution) {
  struct Case {
    float stddev, radius;
  };
  for (const auto& [stddev, radius] : {Case{0.5f, 2.0f}, {0.5f, 0.5f}, {1.0f, 1.5f}, {0.25f, 2.0f}}) {
    const double scale = std::sqrt(2.0) * stddev;
    for (int i = 0; i <= 4096; ++i) {
      const float u = std::min(static_cast<float>(i) / 4096, KB_ONE_MINUS_EPSILON);
      const double x = kb_filter_gaussian(u, stddev, radius);
      ASSERT_LE(std::fabs(x), radius);
      EXPECT_NEAR(0.5 + 0.5 * std::erf(x / scale) / std::erf(radius / scale), u, 3e-7) << stddev << ' ' << u;
    }
  }
}

TEST(FilterSample, FiltersAreSymmetric) {
  for (int i = 1; i < 1024; ++i) {
    const float u = static_cast<float>(i) / 1024;
    EXPECT_NEAR(kb_filter_tent(u, 1.0f), -kb_filter_tent(1 - u, 1.0f), 1e-6);
    EXPECT_NEAR(kb_filter_gaussian(u, 0.5f, 2.0f), -kb_filter_gaussian(1 - u, 0.5f, 2.0f), 1e-6);
  }
}

}  // namespace
