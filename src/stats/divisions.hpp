// Many units under random divisions of their replicates into the two sides, the SAME division for all units;
// for a known truth: random signs.
//
// Of each unit the values x_r of all R replicates, less their mean and scaled to sum x^2 = 1 (truth: less the
// truth). A division is a sign w_r per replicate: + is side A. With s = sum w x, q = sum w x^2, a = s / 2
// (the sum of A's, that of B's is -a)
//     D = a (1 / R_A + 1 / R_B),
//     V = ((1 + q) / 2 - a^2 / R_A) / (R_A (R_A - 1)) + ((1 - q) / 2 - a^2 / R_B) / (R_B (R_B - 1)),
// in which q drops out where R_A = R_B. A truth: a = s, D = a / R, V = (1 - a^2 / R) / (R (R - 1)).
// Counted are cells of u = t^2 / (t^2 + 4), which is monotone in |t| and stays in [0, 1] without any
// variance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stats/division_kernels.hpp"
#include "stats/random.hpp"

namespace kiloband::stats {

/// Units per cell of |t|, in rising order.
inline constexpr std::size_t kCells = 512;
using Cells = std::array<uint32_t, kCells>;

/// [replicate] 1: side A, -1: side B; or the signs of differences from a truth.
using Division = std::vector<float>;

class DividedUnits {
 public:
  /// second: 0 for a truth. At least two replicates on a side.
  DividedUnits(std::size_t first, std::size_t second);

  /// values: of A's replicates, then of B's; or differences from the truth. They vary. slack: a difference of
  /// the sides that counts as none as they are observed.
  void add(std::vector<double> values, double slack);
  std::size_t size() const { return count_of_units_; }

  /// Cells of the units as they are: (|D| - slack) / sqrt(V).
  Cells observed() const;
  /// A division at random. Exchanging sides of equal size changes no |t|: of two such divisions always the
  /// same one comes, so that ties are ties to the last bit.
  Division draw(Random& random) const;
  /// Cells of the units under each division, without slack.
  std::vector<Cells> divided(const std::vector<Division>& divisions) const;

 private:
  void add_block(std::size_t block, const Division& division, bool with_slack, Cells& cells) const;

  std::size_t first_, second_, count_;
  DividedForms forms_;
  std::size_t count_of_units_ = 0;
  std::vector<float> values_;  // [block of units][replicate][unit of the block]
  std::vector<float> slack_;   // [unit], whole blocks
};

}  // namespace kiloband::stats
