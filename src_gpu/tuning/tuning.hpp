// What a device does best with: sizes that change its speed, and no image.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "src_gpu/device/device.hpp"

namespace kiloband::opencl {

/// Sizes of the pipeline; nothing: the backend's own choice. Images are the same bits with all of them, but for the rounding of derived
/// channels, whose parts are added up by work-items (evaluation_group).
struct Tuning {
  std::optional<uint32_t> pool_slots;        // paths in flight
  std::optional<uint64_t> round_paths;       // dpept: paths that are generated, then evaluated together
  std::optional<uint32_t> path_group;        // work-items of a group in path generation; CPU devices have one
  std::optional<uint32_t> evaluation_group;  // at most, in evaluation; CPU devices have one

  bool operator==(const Tuning&) const = default;
};

/// The same with what `first` says wherever it says something.
Tuning merged(const Tuning& first, const Tuning& second);

/// "paths in flight 16384, paths of a round 131072"; "the usual sizes" where nothing is said.
std::string describe(const Tuning& tuning);

/// A measurement of `kiloband tune`.
struct TunedMethod {
  std::string method;     // "dpept-batch"
  uint32_t channels = 0;  // K
  /// EvaluationShape::local_size with the usual sizes: groups of others are filled by other numbers of pixels.
  uint32_t items_of_path = 1;
  Tuning tuning;
  std::string scene;    // it was measured in
  double speed_up = 1;  // over the usual sizes
};

/// The tuning for a method: of those at other numbers of channels the nearest, by ratio; empty where the method has none. Its group of
/// evaluation only where as many work-items share a path as in what was measured.
Tuning tuning_for(const std::vector<TunedMethod>& tuned, const std::string& method, uint32_t channels,
                  uint32_t items_of_path);

}  // namespace kiloband::opencl
