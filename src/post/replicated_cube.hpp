// A cube together with the cubes of its replicates (--keep-replicates): where error bars of sums come from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband {

/// Any number that is a linear function of the image can be computed from each replicate alone; the spread of
/// the results is the error of the whole (statistics.hpp has the formula),
/// whatever pixels and channels have in common.
struct ReplicatedCube {
  std::unique_ptr<CubeReader> mean;
  std::vector<std::unique_ptr<CubeReader>> replicates;  // empty: no error bars; at least 2 otherwise
  std::vector<double> samples;                          // of each replicate; 0: it was never begun
  uint32_t least_replicates = 0;                        // that a pixel with two or more has

  bool has_errors() const { return !replicates.empty(); }
  /// The same with `change` applied to each cube.
  ReplicatedCube transformed(
      const std::function<std::unique_ptr<CubeReader>(std::unique_ptr<CubeReader>)>& change) &&;
};

/// Standard error of a mean from its values in the replicates. Those that have no value (NaN: an interrupted render has not reached all
/// that it is of) or no samples are left out; NaN with fewer than two.
double replicate_error(std::span<const double> values, std::span<const double> samples);

/// How many of these are numbers: one more than the degrees of freedom of their error.
std::size_t count_values(std::span<const double> values);

/// "X.r03.hdr" of "X.hdr": what the render calls a replicate's cube.
std::filesystem::path replicate_path(const std::filesystem::path& file, uint32_t replicate);

/// X.hdr with X.r00.hdr, X.r01.hdr ..., which --keep-replicates writes; without them if there are none. The header of X says how many
/// there are, and how many samples each has; of files before this was stated all are taken to have equally many.
/// throws InputError  some of them are missing, or belong to another render
ReplicatedCube open_replicated_cube(const std::filesystem::path& file, const DiagnosticSink& sink = {});

/// The mean with the variances that its replicates give, for every band. Keeps the cube's own variances where
/// there are no replicates.
std::unique_ptr<CubeReader> with_replicate_variance(ReplicatedCube cube);

}  // namespace kiloband
