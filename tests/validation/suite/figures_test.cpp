// Figures of hard cases: what is not a number is never within a limit, and families are bounded.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/suite.hpp"

namespace kiloband::test {
namespace {

using validation::HardCaseResult;
using validation::HardFigure;
using validation::Trial;

/// Three pixels of one channel of 1 nm.
validation::TrialImage image_of(std::vector<double> mean) {
  validation::TrialImage image{3, 1, 1, 2, {1}, std::move(mean), {1}, {0}};
  image.samples = 1;
  return image;
}

TEST(HardFigures, APixelThatIsNotANumberStaysTheWorst) {
  const validation::HardCaseContext context;
  Trial trial(context);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  trial.exact("right", image_of({2, 2, 2}), 0, 2, 1e-6, "");
  trial.exact("off", image_of({2, 2.1, 2}), 0, 2, 1e-6, "");
  trial.exact("not a number", image_of({2, kNan, 2}), 0, 2, 1e-6, "");
  const std::vector<HardFigure> figures = trial.finish();
  EXPECT_TRUE(figures[0].pass);
  EXPECT_FALSE(figures[1].pass);
  EXPECT_NEAR(figures[1].error, 0.05, 1e-12);
  EXPECT_FALSE(figures[2].pass);
  EXPECT_TRUE(std::isnan(figures[2].error));
}

TEST(HardFigures, AtLeast) {
  const validation::HardCaseContext context;
  Trial trial(context);
  trial.at_least("enough", "rays", 30, 30, "");
  trial.at_least("too few", "rays", 29, 30, "");
  trial.at_least("none", "rays", std::numeric_limits<double>::quiet_NaN(), 30, "");
  const std::vector<HardFigure> figures = trial.finish();
  EXPECT_TRUE(figures[0].pass);
  EXPECT_FALSE(figures[1].pass);
  EXPECT_EQ(figures[1].error, 1);
  EXPECT_FALSE(figures[2].pass);
}

/// More statistical figures than the rate is divided over are a failure, per backend.
TEST(HardFigures, StatisticalOnesAreBounded) {
  HardFigure figure;
  figure.pass = figure.statistical = true;
  const auto result = [&](const std::string& backend, std::size_t figures) {
    return HardCaseResult{"a", "", backend, std::vector<HardFigure>(figures, figure), true, {}};
  };
  const std::size_t half = validation::kHardStatisticalFigures / 2;
  std::vector<HardCaseResult> results{result("cpu", half), result("opencl:pt", half + 1), result("cpu", half),
                                      result("opencl:pt", half)};
  results[2].figures.push_back({});  // not statistical
  validation::bound_statistical_figures(results);
  EXPECT_TRUE(results[0].passed && results[1].passed && results[2].passed);
  EXPECT_FALSE(results[3].passed);
  EXPECT_EQ(results[3].error, "101 statistical figures so far, the rate is divided over 100");
}

}  // namespace
}  // namespace kiloband::test
