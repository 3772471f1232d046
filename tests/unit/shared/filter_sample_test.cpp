// erf^-1 against Boost.
#include "shared/filter_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>

namespace {

// The bound that the header states. All multiples of 2^-24 near the ends, a grid between.
TEST(ErfInv, IsWithinItsBound) {
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

}  // namespace
