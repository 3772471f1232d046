// The search finds the fastest rungs of speeds that are known, and measures no more than it must.
#include "src_gpu/tuning/ladder_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace kiloband::test::ladder_search_test {
namespace {

using namespace opencl;

const auto kNeverStop = [] { return false; };

std::vector<Ladder> two_ladders() {
  return {{"a", {1, 2, 4, 8, 16, 32}, 2}, {"b", {10, 20, 30, 40}, 3}};
}

/// Speeds with one peak, at the rungs `peak`: each rung away from it costs a tenth.
SpeedOver peaked(const Rungs& peak) {
  const auto speed = [peak](const Rungs& rungs) {
    double product = 1;
    for (std::size_t l = 0; l < rungs.size(); ++l)
      product *= std::pow(0.9, std::abs(static_cast<double>(rungs[l]) - static_cast<double>(peak[l])));
    return product;
  };
  return [speed](const Rungs& best, const Rungs& other) { return speed(other) / speed(best); };
}

TEST(LadderSearch, FindsThePeakWhereverItIs) {
  for (std::size_t a = 0; a < 6; ++a) {
    for (std::size_t b = 0; b < 4; ++b)
      EXPECT_EQ(climb(two_ladders(), 1.02, peaked({a, b}), kNeverStop), (Rungs{a, b}));
  }
}

TEST(LadderSearch, StaysWhereNothingIsFasterEnough) {
  const SpeedOver barely = [](const Rungs&, const Rungs&) { return 1.01; };
  EXPECT_EQ(climb(two_ladders(), 1.02, barely, kNeverStop), (Rungs{2, 3}));
}

TEST(LadderSearch, StepsOverOneRungThatGainsNothing) {
  const std::vector<Ladder> ladder{{"a", {1, 2, 4, 8}, 0}};
  const double speeds[] = {1, 1.01, 1.1, 0.5};
  const SpeedOver bumpy = [&](const Rungs& best, const Rungs& other) {
    return speeds[other[0]] / speeds[best[0]];
  };
  EXPECT_EQ(climb(ladder, 1.02, bumpy, kNeverStop), Rungs{2});
}

TEST(LadderSearch, WhatDoesNotWorkIsNotTaken) {
  const SpeedOver broken = [](const Rungs&, const Rungs&) { return 0.0; };
  EXPECT_EQ(climb(two_ladders(), 1.02, broken, kNeverStop), (Rungs{2, 3}));
}

TEST(LadderSearch, MeasuresNothingTwice) {
  std::multiset<std::pair<Rungs, Rungs>> measured;
  const SpeedOver speeds = peaked({5, 0});
  climb(
      two_ladders(), 1.02,
      [&](const Rungs& best, const Rungs& other) {
        measured.emplace(best, other);
        return speeds(best, other);
      },
      kNeverStop);
  for (const auto& pair : measured) EXPECT_EQ(measured.count(pair), 1u);
}

TEST(LadderSearch, StopsWithTheBestSoFar) {
  int measurements = 0;
  const SpeedOver speeds = peaked({5, 0});
  const Rungs best = climb(
      two_ladders(), 1.02,
      [&](const Rungs& a, const Rungs& b) {
        ++measurements;
        return speeds(a, b);
      },
      [&] { return measurements == 2; });
  EXPECT_EQ(measurements, 2);
  EXPECT_EQ(best, (Rungs{4, 3}));
}

}  // namespace
}  // namespace kiloband::test::ladder_search_test
