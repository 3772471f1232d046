#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "spectral/spectrum.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

/// Largest |table - spectrum| on dense and random points of the interval.
double measured_error(const RegularTable& table, const Spectrum& spectrum, double min_nm, double max_nm) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(min_nm, max_nm);
  double error = 0;
  for (int i = 0; i <= 20000; ++i) {
    const double lambda_nm = i % 2 ? uniform(generator) : min_nm + (max_nm - min_nm) * i / 20000;
    error = std::max(error, std::abs(table(lambda_nm) - spectrum(lambda_nm)));
  }
  return error;
}

TEST(Resample, ConstantNeedsTwoEntries) {
  const RegularTable table = resample(Spectrum::constant(0.7), 400, 900);
  EXPECT_EQ(table.values, (std::vector<double>{0.7, 0.7}));
  EXPECT_EQ(table.min_nm, 400);
  EXPECT_EQ(table.step_nm, 500);
  EXPECT_TRUE(table.extrapolate);
  EXPECT_EQ(table(5), 0.7);
  EXPECT_EQ(table.max_error, 0);
}

TEST(Resample, RegularDataAreTakenOver) {
  std::vector<double> knots, values;
  for (int i = 0; i < 76; ++i) {
    knots.push_back(400 + 4 * i);
    values.push_back(0.1 * (i % 7));
  }
  const Spectrum s = Spectrum::tabulated(knots, values);
  const RegularTable whole = resample(s, 300, 2000);
  EXPECT_EQ(whole.values, values);
  EXPECT_EQ(whole.min_nm, 400);
  EXPECT_EQ(whole.step_nm, 4);
  EXPECT_FALSE(whole.extrapolate);
  EXPECT_EQ(whole(399.999), 0);
  EXPECT_EQ(whole(700), values.back());
  EXPECT_EQ(whole(700.001), 0);

  const RegularTable part = resample(s, 450, 500);
  EXPECT_EQ(part.min_nm, 448);
  EXPECT_EQ(part.values.size(), 15u);  // to 504: a hair beyond 500 is still data
  EXPECT_EQ(measured_error(part, s, 450, 500), 0);
}

// As Mitsuba 3: spacing within 1e-3 of the step counts as regular, but only where the bound holds.
TEST(Resample, NearlyRegularDataAreTakenOver) {
  const Spectrum s = Spectrum::tabulated({400, 410.005, 420, 429.996}, {1, 2, 4, 3});
  const RegularTable table = resample(s, 380, 780, {1e-3, 1u << 20});
  EXPECT_EQ(table.values, (std::vector<double>{1, 2, 4, 3}));
  EXPECT_GT(table.max_error, 0);
  EXPECT_LE(measured_error(table, s, 400, 429.99), table.max_error);
}

// An instrument's steps of 10/3 nm, which its file gives with three decimals.
TEST(Resample, RoundedStepsOfAnInstrumentAreTakenOver) {
  std::vector<double> knots, values;
  for (int i = 0; i < 300; ++i) {
    knots.push_back(std::round((350 + i * 10 / 3.0) * 1000) / 1000);
    values.push_back(0.5 + 0.3 * std::sin(0.1 * i));
  }
  const RegularTable table = resample(Spectrum::tabulated(knots, values), 300, 2500, {1e-5, 1u << 20});
  EXPECT_EQ(table.values, values);
  EXPECT_LE(table.max_error, 0.8e-5);
}

TEST(Resample, NearlyRegularDataMeetTheBound) {
  for (const double bound : {1e-3, 1e-4, 1e-5}) {
    for (const Spectrum& s : {Spectrum::tabulated({400, 500.09, 600}, {0, 1, 0}),
                              Spectrum::tabulated({400, 499.91, 600}, {0, 0, 1}),
                              Spectrum::tabulated({400, 410.005, 420, 429.996}, {1, 2, 4, 3}),
                              Spectrum::tabulated({400, 410.00731, 420, 430}, {0, 3, 0, 2}, true)}) {
      const RegularTable table = resample(s, 380, 780, {bound, 1u << 20});
      EXPECT_LE(table.max_error, bound * s.max_over(380, 780)) << bound;
      EXPECT_LE(measured_error(table, s, 400, 429.995), table.max_error + 1e-13) << bound;
      EXPECT_LE(measured_error(table, s, 430.1, 780), table.max_error + 1e-13) << bound;
    }
  }
}

// A peak beside the range that was asked for is no error inside.
TEST(Resample, OnlyTheRangeThatIsAskedForMeetsTheBound) {
  const Spectrum s = Spectrum::tabulated({400, 410.0071, 420.0013, 430.0057, 440}, {1e6, 2, 3, 2.9, 2.5});
  const RegularTable table = resample(s, 410.0071, 430, {1e-3, 1u << 20});
  EXPECT_LE(table.values.size(), 6u);
  EXPECT_LE(measured_error(table, s, 410.0072, 430), table.max_error);
  EXPECT_LE(table.max_error, 3e-3);
}

TEST(Resample, IrregularDataOnACommonLatticeAreExact) {
  const Spectrum s = Spectrum::tabulated({400, 402.5, 410, 440, 700}, {0, 1, 0.2, 0.9, 0.3});
  const RegularTable table = resample(s, 380, 780);
  EXPECT_DOUBLE_EQ(table.step_nm, 2.5);
  EXPECT_EQ(table.min_nm, 400);
  EXPECT_EQ(table.values.size(), 121u);
  EXPECT_LT(measured_error(table, s, 380, 780), 1e-12);
}

/// Lines of 0.1 nm on a lattice of 0.01 nm, whose ground has its next points far outside of what is asked for: the ends of
/// the table are on the data's lattice, too.
TEST(Resample, LinesOnALatticeAreExactBetweenDistantKnots) {
  const Spectrum lines =
      Spectrum::tabulated({250, 500, 500.05, 500.1, 612.03, 612.08, 612.13, 950}, {1, 1, 10, 1, 1, 5, 1, 2});
  const RegularTable table = resample(lines, 400, 700, {.relative_error = 1e-5});
  EXPECT_NEAR(table.step_nm, 0.01, 1e-12);
  EXPECT_LT(table.values.size(), 30010u);
  EXPECT_LE(table.min_nm, 400);
  EXPECT_TRUE(table.extrapolate);
  EXPECT_LT(measured_error(table, lines, 400, 700), 1e-8);
  EXPECT_NEAR(table(500.05), 10, 1e-6);
  // A far knot within a step beyond what is asked for bends the line there: the bound is kept.
  const Spectrum coarse = Spectrum::tabulated({345, 430, 470, 800}, {5, 1, 2, 0});
  const RegularTable bent = resample(coarse, 400, 700, {.relative_error = 1e-4});
  EXPECT_LE(bent.max_error, 1e-4 * 5);
  EXPECT_LE(measured_error(bent, coarse, 400, 700), 1.01e-4 * 5);
}

/// Wavelengths of two and three decimals: a step found by subtracting alone is too inexact after 10^5 of them.
TEST(Resample, LinesWhoseWavelengthsAreDecimalsAreExact) {
  std::mt19937 generator(3);
  for (const int digits : {2, 3})
    for (int i = 0; i < 20; ++i) {
      const double unit = std::pow(10, -digits);
      const double width = unit * std::uniform_int_distribution<int>(1, 20)(generator);
      const double centre =
          unit * std::round(std::uniform_real_distribution<double>(410, 690)(generator) / unit);
      const auto rounded = [&](double nm) { return std::round(nm / unit) * unit; };
      const Spectrum line = Spectrum::tabulated(
          {400, rounded(centre - width), centre, rounded(centre + width), 700}, {1, 1, 500, 1, 1});
      const RegularTable table = resample(line, 400, 700, {.relative_error = 1e-5});
      EXPECT_NEAR(table(centre), 500, 5e-3) << centre << " " << width;
      EXPECT_NEAR(table(0.5 * (centre + rounded(centre + width))), 250.5, 5e-3) << centre << " " << width;
      EXPECT_LE(measured_error(table, line, 400, 700), 5e-3) << centre << " " << width;
    }
  const Spectrum line = Spectrum::tabulated({400, 450.003, 450.013, 450.023, 600}, {1, 1, 500, 1, 1});
  EXPECT_EQ(resample(line, 400, 600, {.relative_error = 1e-5}).values.size(), 200001u);
}

TEST(Resample, IrregularDataMeetTheBound) {
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> knots, values;
  for (double x = 350.123; x < 2500; x += 5 + 30 * uniform(generator)) {
    knots.push_back(x);
    values.push_back(uniform(generator));
  }
  for (const bool extrapolate : {false, true}) {
    const Spectrum s = Spectrum::tabulated(knots, values, extrapolate);
    for (const double bound : {1e-1, 1e-3}) {
      const RegularTable table = resample(s, 300, 3000, {bound, 1u << 20});
      EXPECT_LE(measured_error(table, s, 300, 3000), table.max_error);
      EXPECT_LE(table.max_error, bound);
      EXPECT_EQ(table.extrapolate, extrapolate);
    }
    EXPECT_LT(resample(s, 300, 3000, {1e-1, 1u << 20}).values.size(),
              resample(s, 300, 3000, {1e-3, 1u << 20}).values.size());
  }
}

TEST(Resample, EdgesOfTheDataStaySharp) {
  const Spectrum s = Spectrum::tabulated({400.3, 411, 633.7}, {1, 0.8, 1});
  const RegularTable table = resample(s, 380, 780);
  EXPECT_EQ(table(400.29999), 0);
  EXPECT_EQ(table(400.3), 1);
  EXPECT_NEAR(table(633.7), 1, 1e-4);
  EXPECT_EQ(table(633.70001), 0);
}

TEST(Resample, OneEndCutByTheRequest) {
  const Spectrum s = Spectrum::tabulated({400.3, 411, 900.7}, {1, 0.8, 1});
  const RegularTable table = resample(s, 380, 780);
  EXPECT_EQ(table(400.29), 0);
  // A wavelength that single precision rounds to beyond the request still reads the data.
  EXPECT_NEAR(table(static_cast<double>(std::nextafter(780.0f, 1000.0f))), s(780), 1e-4);
}

TEST(Resample, SmoothSpectraMeetTheBound) {
  const Spectrum cases[] = {
      Spectrum::sigmoid({1e-4, -0.1, 20}, 1),
      Spectrum::sigmoid({-4, 4400, -1210000 + 2}, 1),
      Spectrum::planck(300, 1),
      Spectrum::planck(5800, 1, Spectrum::Range{360, 830}),
      Spectrum::product(Spectrum::planck(1000, 1), Spectrum::tabulated({500, 512, 9000}, {0, 1, 0.2})),
      Spectrum::product(Spectrum::sigmoid({1e-4, -0.1, 20}, 1),
                        Spectrum::tabulated({500, 512, 600}, {1, 3, 2}))};
  for (const Spectrum& s : cases) {
    const RegularTable table = resample(s, 350, 14000);
    EXPECT_LE(measured_error(table, s, 350, 14000), table.max_error);
    EXPECT_LE(table.max_error, 1e-4 * std::abs(s.max_over(350, 14000)));
  }
}

TEST(Resample, SigmoidTableEndsWhereItIsFlat) {
  const RegularTable table = resample(Spectrum::sigmoid({1e-4, -0.1, 20}, 1), 350, 14000);
  EXPECT_EQ(table.min_nm, 360);
  EXPECT_TRUE(table.extrapolate);
  const RegularTable far = resample(Spectrum::sigmoid({1e-4, -0.1, 20}, 1), 8000, 14000);
  EXPECT_EQ(far.values.size(), 2u);
  EXPECT_EQ(far(9000), Spectrum::sigmoid({1e-4, -0.1, 20}, 1)(9000));
}

TEST(Resample, RequestBesideTheData) {
  const Spectrum s = Spectrum::tabulated({400, 500}, {1, 2});
  for (const auto& [a, b] : {std::pair{600.0, 700.0}, {500.0, 700.0}}) EXPECT_EQ(resample(s, a, b)(650), 0);
  EXPECT_EQ(resample(s.extrapolated(), 600, 700)(650), 2);
  EXPECT_EQ(resample(Spectrum::tabulated({500}, {1}), 400, 600)(450), 0);
}

TEST(Resample, AStepThatNeedsTooManyEntriesIsAnError) {
  const Spectrum s = Spectrum::tabulated({400, 500, 500.00001, 777.7}, {0, 0, 1, 1});
  EXPECT_EQ(error_of([&] {
              resample(s, 380, 780, {1e-4, 1025});
            }).substr(0, 62),
            "spectrum: 1025 entries over 400 to 777.7 nm reach an error of ");
  EXPECT_THROW(resample(s, 500, 400), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test
