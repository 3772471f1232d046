// A search for the fastest of a few settings whose speeds are measured, with noise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace kiloband::opencl {

/// A setting, and the values that it may have, from small to large.
struct Ladder {
  std::string name;
  std::vector<uint64_t> values;
  std::size_t start = 0;  // where the search begins
};

/// A rung of every ladder.
using Rungs = std::vector<std::size_t>;

/// How many times faster `other` is than `best`, both measured in turns; 0: it does not work.
using SpeedOver = std::function<double(const Rungs& best, const Rungs& other)>;

/// Climbs the ladders one after another, up or down by one rung or by two, as long as that is `least_gain` (above 1) times faster; again
/// until a round over all ladders changed nothing, at most three. Nothing is measured twice against the same best.
/// stop  asked before every measurement; the best so far is returned
Rungs climb(const std::vector<Ladder>& ladders, double least_gain, const SpeedOver& speed_over,
            const std::function<bool()>& stop);

}  // namespace kiloband::opencl
