// Planck's law against independent long double evaluations and published values.
#include <gtest/gtest.h>

#include <cmath>

#include "spectral/planck.hpp"

namespace kiloband::test {
namespace {

constexpr long double kC1 = 2.0L * 6.62607015e-34L * 299792458.0L * 299792458.0L;  // 2 h c^2, W m^2
constexpr long double kC2 = 6.62607015e-34L * 299792458.0L / 1.380649e-23L;        // h c / k, m K

/// In metres and long double, whose exponent range holds every intermediate value.
long double reference(long double lambda_nm, long double temperature_k) {
  const long double m = lambda_nm * 1e-9L;
  return 1e-9L * kC1 / (m * m * m * m * m) / expm1l(kC2 / (m * temperature_k));
}

/// Radiance below lambda by the exponential series of the fractional function (Siegel & Howell, Thermal
/// Radiation Heat Transfer): 2 k^4 T^4 / (h^3 c^2) sum_n exp(-n x) (x^3/n + 3 x^2/n^2 + 6 x/n^3 + 6/n^4).
long double series_below(long double lambda_nm, long double temperature_k) {
  const long double x = kC2 / (lambda_nm * 1e-9L * temperature_k);
  long double sum = 0;
  for (int n = 1; n < 20000; ++n) {
    const long double i = 1.0L / n, term = expl(-n * x) * (x * x * x * i + 3 * x * x * i * i +
                                                           6 * x * i * i * i + 6 * i * i * i * i);
    sum += term;
    if (term < 1e-22L * sum) break;
  }
  const long double kt = 1.380649e-23L * temperature_k;
  return 2 * kt * kt * kt * kt /
         (6.62607015e-34L * 6.62607015e-34L * 6.62607015e-34L * 299792458.0L * 299792458.0L) * sum;
}

TEST(Planck, MatchesLongDoubleOverTheWholeDomain) {
  for (const double lambda_nm : {200.0, 300.0, 380.0, 555.0, 1064.0, 4000.0, 1e4, 2e4, 1e6, 1e9})
    for (const double temperature_k : {3.0, 77.0, 200.0, 300.0, 1500.0, 2856.0, 6000.0, 1e5}) {
      const long double expected = reference(lambda_nm, temperature_k);
      if (expected < 1e-290L) continue;
      EXPECT_NEAR(static_cast<double>(planck_radiance(lambda_nm, temperature_k) / expected), 1.0, 1e-13)
          << lambda_nm << " nm " << temperature_k << " K";
    }
}

TEST(Planck, IsTinyButNotZeroAtTheColdUltraviolet) {
  const double value = planck_radiance(300, 200);
  EXPECT_GT(value, 1e-97);
  EXPECT_LT(value, 1e-95);
  EXPECT_GT(planck_radiance(300, 70), 0);  // 1e-290
  EXPECT_EQ(planck_radiance(300, 20), 0);
  EXPECT_EQ(planck_radiance(300, 0), 0);
}

// Published blackbody tables give 9.924 W m^-2 sr^-1 um^-1 at 10 um and 300 K.
TEST(Planck, PublishedRadianceAtTenMicrometres) {
  EXPECT_NEAR(planck_radiance(1e4, 300) * 1000, 9.924, 5e-4);
}

// Wien's displacement law, CODATA 2018: 2897.771955 um K.
TEST(Planck, PeaksWhereWienSays) {
  const double peak_nm = 2.897771955e6 / 1000;
  EXPECT_GT(planck_radiance(peak_nm, 1000), planck_radiance(peak_nm * 1.001, 1000));
  EXPECT_GT(planck_radiance(peak_nm, 1000), planck_radiance(peak_nm * 0.999, 1000));
}

// Stefan-Boltzmann, CODATA 2018: 5.670374419e-8 W m^-2 K^-4; the exitance is pi times the radiance.
TEST(Planck, TotalIsStefanBoltzmann) {
  for (const double temperature_k : {10.0, 300.0, 6000.0})
    EXPECT_NEAR(
        planck_integral(1, 1e12, temperature_k) * M_PI / (5.670374419e-8 * std::pow(temperature_k, 4)), 1,
        1e-9);
}

// Fractions of the total below lambda T in um K, Siegel & Howell, table A-5. The table was computed with the
// constants of its time; up to 5e-5 of a value is theirs.
TEST(Planck, PublishedFractions) {
  const std::pair<double, double> table[] = {
      {1000, 0.000321}, {2000, 0.066728}, {4000, 0.480877}, {6000, 0.737818}, {10000, 0.914199}};
  for (const auto& [lambda_t, fraction] : table) {
    const double total = planck_integral(1, 1e12, 500);
    EXPECT_NEAR(planck_integral(1, lambda_t * 1000 / 500, 500) / total, fraction, 5e-5 * fraction + 1e-6)
        << lambda_t;
  }
}

TEST(Planck, IntegralMatchesTheSeriesForWideBands) {
  const std::pair<double, double> bands[] = {
      {300, 20000}, {3000, 5000}, {8000, 12000}, {380, 780}, {300, 400}};
  for (const auto& [min_nm, max_nm] : bands)
    for (const double temperature_k : {200.0, 300.0, 1500.0, 6000.0}) {
      const long double expected = series_below(max_nm, temperature_k) - series_below(min_nm, temperature_k);
      EXPECT_NEAR(static_cast<double>(planck_integral(min_nm, max_nm, temperature_k) / expected), 1, 1e-10)
          << min_nm << ' ' << max_nm << ' ' << temperature_k;
    }
}

// The series would lose seven digits here; Simpson's rule in long double on 8000 parts does not.
TEST(Planck, IntegralOfNarrowChannels) {
  for (const double temperature_k : {200.0, 300.0, 6000.0})
    for (const double min_nm : {300.0, 555.0, 10000.0})
      for (const double width_nm : {0.1, 1.0, 13.0, 40.0}) {
        const int parts = 8000;
        long double sum = 0;
        for (int i = 0; i <= parts; ++i)
          sum += (i == 0 || i == parts ? 1
                  : i % 2              ? 4
                                       : 2) *
                 reference(min_nm + (static_cast<long double>(min_nm + width_nm) - min_nm) * i / parts,
                           temperature_k);
        sum *= (static_cast<long double>(min_nm + width_nm) - min_nm) / (3.0L * parts);
        EXPECT_NEAR(static_cast<double>(planck_integral(min_nm, min_nm + width_nm, temperature_k) / sum), 1,
                    1e-10)
            << min_nm << ' ' << width_nm << ' ' << temperature_k;
      }
}

TEST(Planck, IntegralOfNothing) {
  EXPECT_EQ(planck_integral(500, 500, 300), 0);
  EXPECT_EQ(planck_integral(1, 10, 300), 0);
  EXPECT_EQ(planck_integral(500, 600, 0), 0);
}

TEST(Planck, OutsideTheDomainIsOurBug) {
  EXPECT_THROW(planck_radiance(0, 300), std::logic_error);
  EXPECT_THROW(planck_radiance(500, -1), std::logic_error);
  EXPECT_THROW(planck_radiance(std::nan(""), 300), std::logic_error);
  EXPECT_THROW(planck_integral(600, 500, 300), std::logic_error);
  EXPECT_THROW(planck_integral(600, INFINITY, 300), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test
