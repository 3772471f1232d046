// Uniformity of p-values: false alarms where pixels have noise in common, power, when it is not tested, its
// arithmetic.
#include "stats/uniformity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stats/comparison/comparison.hpp"
#include "stats/divisions.hpp"
#include "tests/support/simulated_image.hpp"
#include "tests/unit/stats/support.hpp"

namespace kiloband::stats::uniformity_test {
namespace {

using test::BatchPool;
using test::SimulatedImage;

const TestVerdict* find(const Comparison& c, const char* name) {
  const auto found = std::ranges::find(c.tests, name, &TestVerdict::name);
  return found == c.tests.end() ? nullptr : &*found;
}

bool says(const Comparison& c, const std::string& note) {
  return std::ranges::find(c.notes, note) != c.notes.end();
}

/// 31 % of the variance is common to all pixels. p < 1 % at most 6 times in 60 (binomial: 5e-6 for more);
/// the law of Kolmogorov, scaled to the mean distance of divisions, gave 11.
TEST(Uniformity, NoiseThatPixelsShareRaisesNoFalseAlarms) {
  const BatchPool pool("normal", 1);
  const SimulatedImage shape{32, 32, 32, 1, 0, 0.4};
  int alarms = 0;
  for (uint64_t i = 0; i < 60; ++i) {
    const Comparison c =
        compare_independent(simulate(shape, pool, 2 * i), simulate(shape, pool, 2 * i + 1), {.seed = i});
    ASSERT_NE(find(c, "uniform/pixel"), nullptr);
    alarms += find(c, "uniform/pixel")->p < 0.01;
  }
  EXPECT_LE(alarms, 6);
}

/// Every pixel is off by half a standard error of its difference, up or down, which neither the image nor a
/// tile shows: 18 of 20 such images are found at 1e-3 for the whole. Three seeds; p < 1e-3 in all.
TEST(Uniformity, BiasesOfEveryPixelThatCancel) {
  const BatchPool pool("normal", 1);
  for (uint64_t i = 0; i < 3; ++i) {
    SimulatedImage shape{64, 64, 32, 1, 1};
    const ReplicateImage a = simulate(shape, pool, 2 * i);
    shape.mean = [](uint32_t x, uint32_t y, std::size_t) { return (x + y) % 2 == 0 ? 1.12 : 0.88; };
    const Comparison c = compare_independent(a, simulate(shape, pool, 2 * i + 1), {.seed = i});
    EXPECT_FALSE(c.passed) << i;
    EXPECT_LT(find(c, "uniform/pixel")->p, 1e-3) << i;
    EXPECT_TRUE(find(c, "mean/tile")->passed && find(c, "mean/image")->passed) << i;
  }
}

/// Noise of another spread and skewness has other p-values without any bias: the test would find a difference
/// at 1 % in every such pair.
TEST(Uniformity, NotOfDifferentEstimators) {
  const BatchPool pool("lognormal", 8);
  const SimulatedImage shape{32, 32, 16, 1, 1};
  SimulatedImage quiet = shape;
  quiet.spread = [](uint32_t, uint32_t, std::size_t) { return 0.3; };
  const Comparison c =
      compare_independent(simulate(shape, pool, 1), simulate(quiet, pool, 2), {.variances = false});
  EXPECT_TRUE(c.passed) << c.decisive().name;
  EXPECT_EQ(find(c, "uniform/pixel"), nullptr);
  EXPECT_TRUE(
      says(c, "uniform/pixel: not tested, the noise of the two sides need not have one distribution"));
  const Comparison small =
      compare_independent(simulate({8, 8, 16, 1, 1}, pool, 1), simulate({8, 8, 16, 1, 1}, pool, 2), {});
  EXPECT_TRUE(
      std::ranges::none_of(small.notes, [](const auto& note) { return note.starts_with("uniform"); }));
}

TEST(Uniformity, WantsReplicates) {
  const BatchPool pool("normal", 8);
  for (const uint32_t replicates : {15u, 16u}) {
    const SimulatedImage shape{32, 32, replicates, 1, 1};
    const Comparison c = compare_independent(simulate(shape, pool, 1), simulate(shape, pool, 2), {});
    EXPECT_EQ(find(c, "uniform/pixel") != nullptr, replicates == 16);
    EXPECT_EQ(says(c, "uniform/pixel: not tested, 16 replicates on every side are needed"), replicates == 15);
  }
}

/// Half the pixels are black: those that vary are looked at, all of them.
TEST(Uniformity, PixelsThatVaryCount) {
  const BatchPool pool("normal", 8);
  for (const uint32_t lit : {12u, 13u}) {
    SimulatedImage shape{80, 80, 16, 1, 1};
    shape.mean = [lit](uint32_t, uint32_t y, std::size_t) { return y < lit ? 1.0 : 0.0; };
    const Comparison c = compare_independent(simulate(shape, pool, 1), simulate(shape, pool, 2), {});
    ASSERT_EQ(find(c, "uniform/pixel") != nullptr, lit == 13);
    if (lit == 13) {
      EXPECT_EQ(c.uniform_pixels->units, 1040u);
    }
    EXPECT_EQ(says(c,
                   "uniform/pixel: not tested, 960 pixels vary and have contributions enough and all "
                   "replicates, 1000 are needed"),
              lit == 12);
  }
}

TEST(Uniformity, NoMoreThanItsShareOfManyUnits) {
  const BatchPool pool("normal", 8);
  const SimulatedImage shape{96, 64, 16, 1, 1};
  EXPECT_EQ(compare_independent(simulate(shape, pool, 1), simulate(shape, pool, 2), {}).uniform_pixels->units,
            kUniformityMostUnits);
}

/// A level that divisions cannot tell is not tested rather than passed.
TEST(Uniformity, TinyLevels) {
  const BatchPool pool("normal", 8);
  const SimulatedImage shape{32, 32, 16, 1, 1};
  const Comparison c =
      compare_independent(simulate(shape, pool, 1), simulate(shape, pool, 2), {.alpha = 1e-7});
  EXPECT_EQ(find(c, "uniform/pixel"), nullptr);
  EXPECT_TRUE(
      says(c, "uniform/pixel: not tested, divisions of the replicates do not resolve so small an alpha"));
}

/// Images that are equal, and a difference within the rounding that is a third of a standard error.
TEST(Uniformity, RoundingIsNoDifference) {
  const BatchPool pool("normal", 1);
  SimulatedImage shape{64, 64, 16, 1, 1};
  shape.spread = [](uint32_t, uint32_t, std::size_t) { return 2e-3; };
  const ReplicateImage a = simulate(shape, pool, 1);
  const Comparison equal = compare_independent(a, a, {});
  EXPECT_TRUE(equal.passed) << equal.decisive().name;
  EXPECT_EQ(find(equal, "uniform/pixel")->p, 1);
  shape.mean = [](uint32_t, uint32_t, std::size_t) { return 1 + 8e-4; };
  const Comparison rounded = compare_independent(a, simulate(shape, pool, 2), {.rounding = 1e-3});
  EXPECT_TRUE(rounded.passed) << rounded.decisive().name << " " << rounded.decisive().p;
}

std::size_t cell_of(double t) {
  return static_cast<std::size_t>(kCells * (t * t / (t * t + 4)));
}

/// Cells of single units against the t of their contrast; sides of any size.
TEST(Uniformity, CellsAreThoseOfTheContrast) {
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const std::size_t first = 2 + random.below(6), second = 2 + random.below(6);
    UnitSample a{1, {}, std::vector<double>(first, 1.0)}, b{1, {}, std::vector<double>(second, 1.0)};
    for (std::size_t r = 0; r < first; ++r) a.means.push_back(1e5 + random.normal());
    for (std::size_t r = 0; r < second; ++r) b.means.push_back(1e5 + 3 * random.normal());
    const double t = std::abs(independent_contrast(a, b, 1e-6).t(0));
    std::vector<double> values = a.means;
    values.insert(values.end(), b.means.begin(), b.means.end());
    DividedUnits units(first, second);
    units.add(values, independent_contrast(a, b, 1e-6).slack[0]);
    const Cells cells = units.observed();
    const auto cell = static_cast<std::size_t>(std::ranges::find(cells, 1u) - cells.begin());
    EXPECT_NEAR(static_cast<double>(cell), static_cast<double>(cell_of(t)), 1) << t;
    DividedUnits signs(first, 0);
    for (double& x : a.means) x -= 1e5;
    signs.add(a.means, 0);
    const double t_truth = std::abs(truth_contrast(a, {{0}, {}}, 0).t(0));
    const Cells cells_truth = signs.observed();
    const auto cell_truth =
        static_cast<std::size_t>(std::ranges::find(cells_truth, 1u) - cells_truth.begin());
    EXPECT_NEAR(static_cast<double>(cell_truth), static_cast<double>(cell_of(t_truth)), 1) << t_truth;
  }
}

}  // namespace
}  // namespace kiloband::stats::uniformity_test
