// Absorption in a channel, as sampled and sorted by value: transmittances of both are the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "spectral/channel_knots.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband::test::channel_knots_test {
namespace {

constexpr double kValueError = 3e-4;  // what sorted_knots promises, of the value
constexpr double kLeast = 1e-9;       // of the channel's largest value

struct Integrals {
  double kappa, absorptance, transmittance;
};

/// Integrals over mu of kappa, 1 - exp(-kappa x) and exp(-kappa x), in closed form for each piece.
Integrals integrals(const ChannelKnots& knots, std::size_t k, double metres) {
  Integrals sum{};
  for (uint32_t i = knots.first[k]; i + 1 < knots.first[k + 1]; ++i) {
    const double width = knots.mu[i + 1] - knots.mu[i];
    const double low = std::min(knots.value[i], knots.value[i + 1]);
    const double rise = std::abs(knots.value[i + 1] - knots.value[i]) * metres;
    const double part = rise > 0 ? -std::expm1(-rise) / rise : 1;
    sum.kappa += 0.5 * width * (knots.value[i] + knots.value[i + 1]);
    sum.transmittance += width * std::exp(-low * metres) * part;
    sum.absorptance += width * (-std::expm1(-low * metres) + std::exp(-low * metres) * (1 - part));
  }
  return sum;
}

double largest(const ChannelKnots& knots, std::size_t k) {
  return *std::max_element(knots.value.begin() + knots.first[k], knots.value.begin() + knots.first[k + 1]);
}

void expect_ascending(const ChannelKnots& knots, std::size_t k) {
  const uint32_t first = knots.first[k], last = knots.first[k + 1] - 1;
  ASSERT_LT(first, last);
  EXPECT_EQ(knots.mu[first], 0);
  EXPECT_EQ(knots.mu[last], 1);
  for (uint32_t i = first; i < last; ++i) {
    ASSERT_LE(knots.mu[i], knots.mu[i + 1]) << i;
    ASSERT_LE(knots.value[i], knots.value[i + 1]) << i;
  }
}

/// A value that is off by 3e-4 of itself changes the absorptance 1 - exp(-kappa x) by at most 3e-4 of it, and
/// the transmittance by at most max(t exp(-t)) = 1/e of that.
void expect_same_integrals(const Spectrum& kappa, const ChannelList& channels) {
  const ChannelKnots sampled = sampled_knots(kappa, channels, "gas"), sorted = sorted_knots(sampled);
  for (std::size_t k = 0; k < channels.size(); ++k) {
    expect_ascending(sorted, k);
    const double highest = largest(sampled, k);
    EXPECT_NEAR(largest(sorted, k), highest, (kValueError + kLeast) * highest);
    for (const double depth : {1e-3, 0.1, 1.0, 6.0, 100.0, 1e5}) {
      const double metres = highest > 0 ? depth / highest : 1;
      const Integrals a = integrals(sampled, k, metres), b = integrals(sorted, k, metres);
      const double least = kLeast * depth + 1e-12;
      EXPECT_NEAR(b.kappa, a.kappa, (kValueError + kLeast) * a.kappa + kLeast * highest) << k;
      EXPECT_NEAR(b.absorptance, a.absorptance, kValueError * a.absorptance + least) << k << ' ' << depth;
      EXPECT_NEAR(b.transmittance, a.transmittance, kValueError / std::exp(1) + least) << k << ' ' << depth;
    }
  }
}

Spectrum curve(double from_nm, double to_nm, int points, const std::function<double(double)>& value) {
  std::vector<double> lambda_nm, values;
  for (int i = 0; i < points; ++i) {
    const double t = static_cast<double>(i) / (points - 1);
    lambda_nm.push_back((1 - t) * from_nm + t * to_nm);
    values.push_back(value(i));
  }
  return Spectrum::tabulated(lambda_nm, values);
}

// Without data in three fifths of the channel, where nothing absorbs: 0 up to mu = 0.6, then from 1 to 1.2, for
// any number of points.
TEST(ChannelKnots, AGapBesideTheDataKeepsItsWidth) {
  for (const int points : {2, 11, 101, 1001, 10001}) {
    const Spectrum kappa = curve(4200, 5000, points, [](double i) { return std::fmod(i, 2) > 0 ? 1.2 : 1; });
    const ChannelKnots sorted = sorted_knots(sampled_knots(kappa, {{3000, 5000, ""}}, "gas"));
    const double exact = 0.6 + 0.4 * (std::exp(-5.0) - std::exp(-6.0)) / (5 * 0.2);
    EXPECT_NEAR(integrals(sorted, 0, 5).transmittance, exact, 1e-9) << points;
    EXPECT_EQ(sorted(0, 0.5999), 0) << points;
    EXPECT_NEAR(sorted(0, 0.6001), 1, 3e-4) << points;
    EXPECT_LE(sorted.mu.size(), 5u) << points;
    expect_same_integrals(kappa, {{3000, 5000, ""}, {4100, 4300, ""}, {5000, 5100, ""}});
  }
}

TEST(ChannelKnots, StepsAndFlatPiecesKeepTheirWidths) {
  const ChannelList channels = {{400, 700, ""}, {300, 450, ""}, {540, 541, ""}, {200, 300, ""}};
  expect_same_integrals(Spectrum::tabulated({400, 540, 540.001, 700}, {0.1, 0.1, 2, 2}), channels);
  expect_same_integrals(Spectrum::tabulated({400, 540, 540.5, 700}, {3, 0.001, 2, 0}, true), channels);
  expect_same_integrals(Spectrum::constant(0.7), channels);
  expect_same_integrals(Spectrum::tabulated({400, 500, 600, 700}, {0, 1e-300, 1e-290, 0}), channels);
  // Values that differ by their rounding or a little more, beside steep ones.
  std::mt19937 random(3);
  for (const double noise : {1e-15, 1e-12})
    expect_same_integrals(curve(350, 600, 3001,
                                [&](double i) {
                                  const double step = static_cast<double>(random() % 9);
                                  return i == 700 ? 1e6 : 0.1 * (1 + noise * step);
                                }),
                          channels);
}

TEST(ChannelKnots, SmoothCurvesKeepTheirIntegrals) {
  const ChannelList channels = {{3900, 5100, ""}, {4000, 4700, ""}, {4300, 4301, ""}};
  for (const int points : {3, 30, 3000})
    expect_same_integrals(
        curve(4000, 5000, points, [&](double i) { return std::pow(i / (points - 1) - 0.3, 2); }), channels);
  expect_same_integrals(Spectrum::planck(900, 1e-3), channels);
}

// Peaks of 1e6 over windows of 1e-2, with as many points as files have, at wavelengths without a pattern.
TEST(ChannelKnots, LinesKeepTheirIntegrals) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const int points : {50, 1000, 20000}) {
    std::vector<double> lambda_nm, values;
    for (int i = 0; i < points; ++i) {
      lambda_nm.push_back(4500 + 10 * (i + 0.9 * uniform(random)) / points);
      double sum = 0.01;
      for (double line = 4500.3; line < 4510; line += 1.7)
        sum += 1e6 * uniform(random) / (1 + std::pow((lambda_nm.back() - line) / 0.003, 2));
      values.push_back(sum);
    }
    expect_same_integrals(Spectrum::tabulated(lambda_nm, values),
                          {{4490, 4520, ""}, {4500, 4510, ""}, {4503, 4504, ""}, {4503.7, 4503.71, ""}});
  }
}

TEST(ChannelKnots, RandomCurvesKeepTheirIntegrals) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 500; ++i) {
    std::vector<double> lambda_nm, values;
    for (double x = 400 + 100 * uniform(random); x < 600; x += 1e-3 + 30 * std::pow(uniform(random), 3)) {
      lambda_nm.push_back(x);
      values.push_back(random() % 4 ? std::pow(uniform(random), 8) : static_cast<double>(random() % 3));
    }
    ChannelList channels;
    for (int k = 0; k < 3; ++k) {
      const double from_nm = 380 + 200 * uniform(random);
      channels.push_back({from_nm, from_nm + 1 + 60 * uniform(random), ""});
    }
    expect_same_integrals(Spectrum::tabulated(lambda_nm, values, random() % 2 > 0), channels);
  }
}

}  // namespace
}  // namespace kiloband::test::channel_knots_test
