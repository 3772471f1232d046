#include "viewer/display/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "spectral/planck.hpp"
#include "tests/support/every_target.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/viewer/array_source.hpp"
#include "viewer/display/three_sums.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;

/// 11 bands of 10 nm from 400 nm on, the last one derived; 3 x 2 pixels whose values are pixel + 1 in every band.
ArraySource ramp() {
  std::vector<Band> bands;
  for (int k = 0; k < 11; ++k) bands.push_back({{400 + 10.0 * k, 410 + 10.0 * k, ""}, k == 10});
  std::vector<float> values;
  for (int pixel = 0; pixel < 6; ++pixel)
    for (int k = 0; k < 11; ++k) values.push_back(static_cast<float>(pixel + 1));
  return {3, 2, bands, values};
}

TEST(Plane, WeightsAreSummedOverAllBands) {
  ArraySource source = ramp();
  std::vector<double> units(11, 1.0);
  units[3] = 4;
  source.set_units(units);
  RgbWeights weights(11);
  for (std::size_t k = 0; k < 11; ++k) weights[k] = {1, static_cast<float>(k), k == 3 ? 0.5f : 0.0f};
  for (const unsigned threads : {1u, 2u, 7u}) {
    const Plane plane = weighted_plane(source, weights, threads);
    ASSERT_EQ(plane.values.size(), 18u);
    for (std::size_t pixel = 0; pixel < 6; ++pixel) {
      const float value = static_cast<float>(pixel + 1);
      EXPECT_FLOAT_EQ(plane.values[3 * pixel], 14 * value);  // ten ones and a four
      EXPECT_FLOAT_EQ(plane.values[3 * pixel + 1],
                      (55 + 9) * value);  // 0 + 1 ... + 10, and 3 three times more
      EXPECT_FLOAT_EQ(plane.values[3 * pixel + 2], 2 * value);
    }
  }
}

TEST(Plane, ChannelsAreDensitiesAndDerivedBandsAreNot) {
  const ArraySource source = ramp();
  EXPECT_FLOAT_EQ(channel_plane(source, {2}, 2).values[4], 0.5f);
  EXPECT_FLOAT_EQ(channel_plane(source, {10}, 2).values[4], 5.0f);
}

TEST(Plane, TemperatureOfABlackbody) {
  const float radiance = static_cast<float>(planck_integral(8000, 9000, 301.5));
  const ArraySource source(1, 1, {{{8000, 9000, ""}}}, {radiance});
  EXPECT_NEAR(temperature_plane(source, {0}, 1).values[0], 301.5, 0.03);
}

TEST(Plane, RelativeErrorAddsStandardErrors) {
  ArraySource source(2, 1, {{{400, 410, ""}}, {{410, 420, ""}}}, {1, 3, 0, 0});
  source.set_variances({0.01f, 0.09f, 1, 1});
  const Plane plane = error_plane(source, 1);
  EXPECT_FLOAT_EQ(plane.values[0], 0.1f);  // (0.1 + 0.3) / 4
  EXPECT_TRUE(std::isnan(plane.values[1]));
}

TEST(Plane, BandsWithoutWeightMayBeNothing) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  const std::vector<Band> bands{{{400, 410, ""}}, {{410, 420, ""}}, {{420, 430, ""}}};
  const ArraySource source(3, 1, bands, {1, NAN, 2, 1, kInfinite, 2, NAN, 3, 2});
  const RgbWeights weights{{1, 0, 0}, {0, 0, 0}, {0, 1, 2}};
  const Plane plane = weighted_plane(source, weights, 1);
  for (const std::size_t pixel : {0u, 1u}) {
    EXPECT_EQ(plane.values[3 * pixel], 1);
    EXPECT_EQ(plane.values[3 * pixel + 1], 2);
    EXPECT_EQ(plane.values[3 * pixel + 2], 4);
  }
  EXPECT_TRUE(std::isnan(plane.values[6])) << "its weight is not 0";
  EXPECT_EQ(plane.values[7], 2);
}

TEST(Plane, RelativeErrorIsOfTheBandsThatHaveOne) {
  ArraySource source(3, 1, {{{400, 410, ""}}, {{410, 420, ""}}, {{420, 430, ""}}},
                     {1, 3, 5, 1, 3, 5, NAN, 3, NAN});
  source.set_variances({0.01f, 0.09f, NAN, NAN, NAN, NAN, 1, 0.09f, NAN});
  const Plane plane = error_plane(source, 1);
  EXPECT_FLOAT_EQ(plane.values[0], 0.1f);
  EXPECT_TRUE(std::isnan(plane.values[1]));
  EXPECT_FLOAT_EQ(plane.values[2], 0.1f);
}

/// A flat density is itself, whatever the ranges.
TEST(Plane, RangesAreMeansOfDensities) {
  const ArraySource source = ramp();
  const RgbWeights weights =
      range_weights(source.bands(), {Channel{480, 500, ""}, Channel{435, 455, ""}, Channel{300, 405, ""}});
  const Plane plane = weighted_plane(source, weights, 1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(plane.values[c], 0.1f);
  EXPECT_FLOAT_EQ(weights[3][1], 0.25f / 10);
  EXPECT_EQ(
      error_of([&] {
        range_weights(source.bands(), {Channel{480, 500, ""}, Channel{500, 510, ""}, Channel{400, 405, ""}});
      }),
      "the range 500-510 nm overlaps no channel");
}

TEST(Plane, QuantilesLeaveOutWhatIsNoNumber) {
  Plane plane{101, 2, 1, {}};
  for (int i = 0; i <= 100; ++i) plane.values.push_back(static_cast<float>(i));
  for (int i = 0; i <= 100; ++i) plane.values.push_back(NAN);
  EXPECT_EQ(quantile(plane, 0.99, -1), 99);
  EXPECT_EQ(quantile(plane, 0.01, -1), 1);
  EXPECT_EQ(quantile({1, 1, 1, {NAN}}, 0.5, -1), -1);
  Plane striped{1920, 1080, 1, std::vector<float>(1920 * 1080, 1000)};
  for (std::size_t i = 0; i < striped.values.size(); i += 32)
    striped.values[i] = 1;  // as far apart as the pixels of 2^16
  EXPECT_EQ(quantile(striped, 0.5, -1), 1000);
  EXPECT_EQ(quantile(striped, 0.01, -1), 1);
  EXPECT_EQ(quantile({1, 1, 3, {1, 7, 2}}, 0.5, -1), 7) << "the largest component of a colour";
}

/// For any number of bands, with vectors of any length, wherever a pixel's values begin and where they end.
TEST(ThreeSums, AreSumsOfProducts) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::size_t count = 0; count <= 70; ++count) {
    std::vector<float> numbers[4];  // of `count` numbers behind one more: not aligned, and nothing follows
    double expected[3] = {};
    for (std::vector<float>& some : numbers)
      for (std::size_t k = 0; k <= count; ++k) some.push_back(uniform(random));
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 1; k <= count; ++k) expected[c] += double{numbers[c][k]} * double{numbers[3][k]};
    on_every_target([&] {
      float sums[4] = {-1, -1, -1, -1};
      three_sums({&numbers[0][0] + 1, &numbers[1][0] + 1, &numbers[2][0] + 1}, &numbers[3][0] + 1, count,
                 sums);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(sums[c], expected[c], 1e-6 * (1 + expected[c])) << count;
      EXPECT_EQ(sums[3], -1);
    });
  }
}

}  // namespace
}  // namespace kiloband::test
