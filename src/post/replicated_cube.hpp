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
  std::vector<double> samples;                          // of each replicate

  bool has_errors() const { return !replicates.empty(); }
  /// The same with `change` applied to each cube.
  ReplicatedCube transformed(
      const std::function<std::unique_ptr<CubeReader>(std::unique_ptr<CubeReader>)>& change) &&;
};

/// Standard error of a mean from its values in the replicates; NaN with fewer than two.
double replicate_error(std::span<const double> values, std::span<const double> samples);

/// "X.r03.hdr" of "X.hdr": what the render calls a replicate's cube.
std::filesystem::path replicate_path(const std::filesystem::path& file, uint32_t replicate);

/// X.hdr with X.r00.hdr, X.r01.hdr ..., which --keep-replicates writes; without them if there are none.
/// throws InputError  some of them are missing, or belong to another render
ReplicatedCube open_replicated_cube(const std::filesystem::path& file, const DiagnosticSink& sink = {});

/// The mean with the variances that its replicates give, for every band. Keeps the cube's own variances where
/// there are no replicates.
std::unique_ptr<CubeReader> with_replicate_variance(ReplicatedCube cube);

}  // namespace kiloband
