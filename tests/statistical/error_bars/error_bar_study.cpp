#include "error_bar_study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace kiloband::test {

void ErrorBarStudy::add(std::span<const double> means, std::span<const double> variances) {
  if (reference_.empty()) reference_.assign(means.begin(), means.end());
  if (means.size() != reference_.size() || variances.size() != means.size())
    throw std::logic_error("ErrorBarStudy: the number of units changed");
  Sums& group = groups_[seeds_++ % groups_.size()];
  for (std::vector<double>* sum : {&group.deviation, &group.square, &group.reported})
    sum->resize(means.size());
  ++group.seeds;
  for (std::size_t u = 0; u < means.size(); ++u) {
    const double deviation = means[u] - reference_[u];
    group.deviation[u] += deviation;
    group.square[u] += deviation * deviation;
    group.reported[u] += variances[u];
  }
}

ErrorBarStudy::Sums ErrorBarStudy::all_but(const Sums* left_out) const {
  const std::size_t units = reference_.size();
  Sums total{0, std::vector<double>(units), std::vector<double>(units), std::vector<double>(units)};
  for (const Sums& group : groups_) {
    if (&group == left_out || group.seeds == 0) continue;
    total.seeds += group.seeds;
    for (std::size_t u = 0; u < units; ++u) {
      total.deviation[u] += group.deviation[u];
      total.square[u] += group.square[u];
      total.reported[u] += group.reported[u];
    }
  }
  return total;
}

double ErrorBarStudy::ratio_of(const Sums& sums) {
  double sum = 0;
  std::size_t units = 0;
  for (std::size_t u = 0; u < sums.square.size(); ++u) {
    const double seen =
        (sums.square[u] - sums.deviation[u] * sums.deviation[u] / sums.seeds) / (sums.seeds - 1);
    const double reported = sums.reported[u] / sums.seeds;
    if (reported == 0 && seen == 0) continue;
    sum += seen / reported;  // infinite where no error is reported
    ++units;
  }
  return 1 / std::sqrt(sum / static_cast<double>(units));
}

ErrorBarRatio ErrorBarStudy::ratio() const {
  std::vector<double> partial;  // without one group
  for (const Sums& group : groups_) {
    if (group.seeds > 0) partial.push_back(ratio_of(all_but(&group)));
  }
  const auto count = static_cast<double>(partial.size());
  const double mean = std::accumulate(partial.begin(), partial.end(), 0.0) / count;
  double squares = 0;
  for (const double value : partial) squares += (value - mean) * (value - mean);
  return {ratio_of(all_but(nullptr)), std::sqrt(squares * (count - 1) / count)};
}

double ErrorBarStudy::grand_mean(std::size_t unit) const {
  const Sums total = all_but(nullptr);
  return reference_[unit] + total.deviation[unit] / total.seeds;
}

double ErrorBarStudy::grand_standard_error(std::size_t unit) const {
  const Sums total = all_but(nullptr);
  const double mean = total.deviation[unit] / total.seeds;
  const double variance = (total.square[unit] - total.seeds * mean * mean) / (total.seeds - 1);
  return std::sqrt(variance / total.seeds);
}

void expect_honest(const std::string& name, const ErrorBarStudy& study, double largest_standard_error) {
  constexpr double kTolerance = 0.1;
  const ErrorBarRatio ratio = study.ratio();
  ::testing::Test::RecordProperty(
      name, std::to_string(ratio.value) + " +- " + std::to_string(ratio.standard_error));
  EXPECT_LE(ratio.standard_error, largest_standard_error) << name;
  EXPECT_NEAR(ratio.value, 1, kTolerance) << name;
}

}  // namespace kiloband::test
