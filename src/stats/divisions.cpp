#include "stats/divisions.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kiloband::stats {
namespace {

/// 1 / (n (n - 1)), 0 for a side that is not there.
double per_side(std::size_t n) {
  return n == 0 ? 0 : 1 / (static_cast<double>(n) * (static_cast<double>(n) - 1));
}

double inverse(std::size_t n) {
  return n == 0 ? 0 : 1 / static_cast<double>(n);
}

}  // namespace

DividedUnits::DividedUnits(std::size_t first, std::size_t second)
    : first_(first), second_(second), count_(first + second) {
  const double a = per_side(first), b = per_side(second);
  forms_.half = second == 0 ? 1.0f : 0.5f;
  forms_.of_difference = static_cast<float>(inverse(first) + inverse(second));
  forms_.of_one = static_cast<float>(second == 0 ? a : 0.5 * (a + b));
  forms_.of_q = static_cast<float>(second == 0 ? 0 : 0.5 * (a - b));
  forms_.of_squares = static_cast<float>(a * inverse(first) + b * inverse(second));
  forms_.replicates = count_;
  forms_.needs_q = second != 0 && first != second;
}

void DividedUnits::add(std::vector<double> values, double slack) {
  const double centre =
      second_ == 0 ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(count_);
  // By the largest first, so that no square is below or above what a double holds.
  double largest = 0, squares = 0;
  for (double& x : values) largest = std::max(largest, std::abs(x -= centre));
  if (largest == 0) largest = 1;
  for (double& x : values) squares += (x / largest) * (x / largest);
  const double unit = largest * std::sqrt(squares > 0 ? squares : 1);
  const std::size_t lane = size() % kBlockUnits, block = size() / kBlockUnits;
  if (lane == 0) {
    values_.resize((block + 1) * count_ * kBlockUnits);
    slack_.resize((block + 1) * kBlockUnits);
  }
  for (std::size_t r = 0; r < count_; ++r)
    values_[(block * count_ + r) * kBlockUnits + lane] = static_cast<float>(values[r] / unit);
  slack_[count_of_units_++] = static_cast<float>(slack / unit);
}

void DividedUnits::add_block(std::size_t block, const Division& division, bool with_slack,
                             Cells& cells) const {
  static constexpr float kNone[kBlockUnits] = {};
  const std::size_t begin = block * kBlockUnits, units = std::min(kBlockUnits, count_of_units_ - begin);
  uint32_t cell[kBlockUnits];
  find_cells(forms_, &values_[begin * count_], division.data(), with_slack ? &slack_[begin] : kNone, kCells,
             cell);
  for (std::size_t i = 0; i < units; ++i) ++cells[cell[i]];
}

Cells DividedUnits::observed() const {
  Cells cells{};
  Division division(count_, -1.0f);
  std::fill_n(division.begin(), first_, 1.0f);
  for (std::size_t begin = 0; begin < size(); begin += kBlockUnits)
    add_block(begin / kBlockUnits, division, true, cells);
  return cells;
}

Division DividedUnits::draw(Random& random) const {
  Division division(count_, -1.0f);
  if (second_ == 0) {
    for (float& sign : division) sign = random.uniform() < 0.5 ? -1.0f : 1.0f;
  } else {
    std::fill_n(division.begin(), first_, 1.0f);
    for (std::size_t k = count_ - 1; k > 0; --k) std::swap(division[k], division[random.below(k + 1)]);
  }
  if ((second_ == 0 || first_ == second_) && division[0] < 0) {
    for (float& sign : division) sign = -sign;
  }
  return division;
}

std::vector<Cells> DividedUnits::divided(const std::vector<Division>& divisions) const {
  std::vector<Cells> cells(divisions.size(), Cells{});
  for (std::size_t begin = 0; begin < size(); begin += kBlockUnits) {
    for (std::size_t d = 0; d < divisions.size(); ++d)
      add_block(begin / kBlockUnits, divisions[d], false, cells[d]);
  }
  return cells;
}

}  // namespace kiloband::stats
