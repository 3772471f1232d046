// Fresnel reflectances against the textbook formulas with complex numbers in long double.
#include "shared/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

namespace {

using Real = long double;
using Complex = std::complex<Real>;

struct Exact {
  Real reflectance, cos_t;
};

// r_s = (c - n ct) / (c + n ct), r_p = (n c - ct) / (n c + ct) with complex n
// and ct = sqrt(1 - (1 - c^2) / n^2).
Exact exact_fresnel(Real c, Complex n) {
  const Complex ct = std::sqrt(Complex(1) - (1 - c * c) / (n * n));
  const Real s = std::norm((c - n * ct) / (c + n * ct));
  const Real p = std::norm((n * c - ct) / (n * c + ct));
  return {(s + p) / 2, ct.real()};
}

std::vector<float> cosines() {
  std::vector<float> c{1e-6f, 1e-4f, 0.999999f, 1.0f};
  for (int i = 1; i < 100; ++i) c.push_back(static_cast<float>(i) / 100);
  return c;
}

// Relative to the result, also where F is 1e-13 (n nearly 1). Near the critical angle and at Brewster's angle
// the function itself is steep or zero: the error allowed there is that of an argument off by an ulp, on top.
TEST(Fresnel, DielectricMatchesTheComplexFormula) {
  for (const float eta : {1.5046f / 1.000277f, 1.33f, 1.000277f, 1.0000002f, 2.419f, 4.0f, 0.7f, 0.25f})
    for (const float c : cosines())
      for (const float sign : {1.0f, -1.0f}) {
        const KbFresnel f = kb_fresnel_dielectric(sign * c, eta);
        const Real n = sign > 0 ? Real{eta} : Real{f.eta_it};
        const Exact exact = exact_fresnel(c, n);
        const Real ulp = 1.2e-7L;
        const Real slope = std::fabs(exact_fresnel(c * (1 - ulp), n).reflectance -
                                     exact_fresnel(c * (1 + ulp), n).reflectance) +
                           std::fabs(exact_fresnel(c, n * (1 - ulp)).reflectance -
                                     exact_fresnel(c, n * (1 + ulp)).reflectance);
        EXPECT_NEAR(f.reflectance, exact.reflectance, 2e-6L * exact.reflectance + slope + 1e-14L)
            << eta << ' ' << c * sign;
        EXPECT_EQ(f.eta_it, sign > 0 ? eta : 1 / eta);
        if (exact.cos_t > 1e-3L) {
          EXPECT_NEAR(f.cos_t, -sign * exact.cos_t, 1e-6L / exact.cos_t) << eta << ' ' << c * sign;
        }
      }
}

// F of an index difference d at normal incidence is (d / (2 + d))^2;
// textbook code in float loses it to rounding.
TEST(Fresnel, NearlyEqualIndicesKeepTheirDigits) {
  const float eta = 1.000277f;
  const double d = double{eta} - 1;
  EXPECT_NEAR(kb_fresnel_dielectric(1, eta).reflectance / std::pow(d / (2 + d), 2), 1, 1e-6);
}

TEST(Fresnel, DielectricLimits) {
  for (const float c : {-1.0f, -0.3f, 0.0f, 0.3f, 1.0f}) {
    const KbFresnel matched = kb_fresnel_dielectric(c, 1.0f);  // no interface
    EXPECT_EQ(matched.reflectance, 0.0f);
    EXPECT_EQ(matched.cos_t, -c);
  }
  for (const float eta : {1.5f, 1.0000002f, 0.6f})
    EXPECT_NEAR(kb_fresnel_dielectric(0.0f, eta).reflectance, 1.0f, 2e-7);
  const KbFresnel inside = kb_fresnel_dielectric(-0.5f, 1.5f);  // beyond the critical angle of 41.8 degrees
  EXPECT_EQ(inside.reflectance, 1.0f);
  EXPECT_EQ(inside.cos_t, 0.0f);
  EXPECT_FLOAT_EQ(kb_fresnel_dielectric(1.0f, 1.5f).reflectance, 0.04f);
}

// Stokes: the same refracted ray has the same reflectance from the other side; Snell: sin_i = eta_it sin_t.
TEST(Fresnel, DielectricIsReciprocalAndObeysSnell) {
  for (const float eta : {1.1f, 1.5f, 2.4f})
    for (int i = 5; i <= 100; ++i) {
      const float c = static_cast<float>(i) / 100;
      const KbFresnel in = kb_fresnel_dielectric(c, eta);
      const KbFresnel out = kb_fresnel_dielectric(in.cos_t, eta);
      EXPECT_LT(in.cos_t, 0.0f);
      EXPECT_NEAR(in.reflectance, out.reflectance, 2e-5);
      const double sin_i = std::sqrt(1 - double{c} * c), sin_t = std::sqrt(1 - double{in.cos_t} * in.cos_t);
      EXPECT_NEAR(sin_i, eta * sin_t, 3e-6);
    }
}

}  // namespace
