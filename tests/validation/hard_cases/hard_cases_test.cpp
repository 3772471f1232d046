// The hard cases at their quick level: every figure within its limit. Error rate: kHardFamilyRate for all of
// a run together, see validation/suite/hard_cases/hard_cases.hpp;
// each figure is printed with its error and its limit.
#include "validation/suite/hard_cases/hard_cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "tests/support/render_harness.hpp"

namespace kiloband::test {
namespace {

using validation::hard_cases;
using validation::HardCase;
using validation::HardFigure;

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const HardCase& one : hard_cases()) all.push_back(one.name);
  return all;
}

class HardCases : public testing::TestWithParam<std::string> {};

TEST_P(HardCases, StayWithinTheirLimits) {
  const auto& all = hard_cases();
  const auto one = std::ranges::find(all, GetParam(), &HardCase::name);
  const std::vector<HardFigure> figures = one->run({test_backend_name(), validation::Effort::kQuick, 1, {}});
  ASSERT_GE(figures.size(), 2u);
  for (const HardFigure& f : figures) {
    std::printf("%-16s %-46s %.9g, reference %.9g, error %.2g, limit %.2g\n", one->name.c_str(),
                f.name.c_str(), f.value, f.reference, f.error, f.limit);
    EXPECT_TRUE(std::isfinite(f.value)) << f.name;
    EXPECT_TRUE(f.pass) << f.name << ": " << f.value << " against " << f.reference << " " << f.unit
                        << ", error " << f.error << ", limit " << f.limit << " (" << f.note << ")";
    EXPECT_EQ(f.pass, f.error <= f.limit) << f.name;
  }
}

/// Names of tests: letters and digits.
std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::ranges::replace_if(
      name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(, HardCases, testing::ValuesIn(names()), test_name);

}  // namespace
}  // namespace kiloband::test
