// All units of one scale, tested together.
//
// The p-value of a unit is that of its largest |t| over the channels (max_t.hpp). Over the units: Sidak,
// which bounds two-sided tests of any correlation. A pixel in which hardly any path arrives has no
// distribution to speak of: its channels with fewer than kMinContributions contributions are not tested there
// but pooled with those of the tile, and pools that are still too thin are left to the next scale.
// All of it is counted.
// Against a truth there are no pools: the data say which pixels are thin, and those that happened to receive
// less are darker than the truth, together by many standard errors (two sides are so alike). The tile has
// them all. And what was not tested since it is thin counts among the tests: else those that happened to
// receive more would be tested at the level of few.
#pragma once

#include <cstdint>
#include <vector>

#include "stats/contrast.hpp"
#include "stats/detectable.hpp"
#include "stats/max_t.hpp"

namespace kiloband::stats {

inline constexpr double kMinContributions = 30;

/// The pixels of a unit. pooled: only the thin ones among them.
struct UnitPlace {
  uint32_t x = 0, y = 0, width = 1, height = 1;
  bool pooled = false;
};

/// Channels of units: where they went.
struct EntryCounts {
  std::size_t tested = 0;     // Student's t
  std::size_t constant = 0;   // no variance on either side: compared as they are
  std::size_t thin = 0;       // too few contributions: pooled
  std::size_t unsampled = 0;  // fewer than two replicates with samples on a side
};

struct WorstUnit {
  UnitPlace place;
  std::size_t channel = 0;
  double a = 0, b = 0, difference = 0, standard_error = 0;
  double t = 0, dof = 0;
  double p = 1;  // of the unit, over its channels
};

struct ScaleResult {
  uint32_t columns = 0, rows = 0;  // of the grid of units
  std::size_t units = 0;           // that were tested, pooled ones included
  std::size_t pooled_units = 0;
  EntryCounts entries;
  double p = 1;  // family-wise over units and channels
  WorstUnit worst;
  std::vector<float> t_map;  // [unit of the grid] t of the largest |t|; NaN where nothing was tested
  DetectableBias errors;
};

/// Of a contrast of two sides: what its p depends on.
void set_sides(const Contrast& contrast, std::size_t channel, RelativeError& error);

class ScaleTest {
 public:
  /// columns x rows: grid of units.
  ScaleTest(uint32_t columns, uint32_t rows, uint64_t seed);

  /// index: in the grid; -1 for a pool. wanted: the channels to test (empty: all).
  void add(std::ptrdiff_t index, const UnitPlace& place, const Contrast& contrast,
           const std::vector<bool>& wanted);
  /// pooled: they are added again with a pool, else they are left to the next scale.
  void count_thin(std::size_t entries, bool pooled) {
    result_.entries.thin += entries;
    if (!pooled) left_ += entries;
  }
  /// Entries of a unit that has others.
  void count_unsampled(std::size_t entries) { result_.entries.unsampled += entries; }
  ScaleResult finish();

 private:
  void map(std::ptrdiff_t index, const Strongest& strongest);
  void add_errors(const Contrast& contrast, const std::vector<bool>& wanted);

  uint64_t seed_;
  ScaleResult result_;
  std::size_t left_ = 0;  // thin entries
  double best_p_ = 2;     // of a unit
};

}  // namespace kiloband::stats
